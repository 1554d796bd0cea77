// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The shapes of a scene and of a frame: their JSON and mixtures in, lines and ellipses out.

const SIGMAS_99 = Math.sqrt(-2 * Math.log(0.01));  // 99 % of a Gaussian in the plane lie within

export function showObstacles(scene, theme, fills, outlines, circles) {
  const polygons = scene.obstacles.filter((o) => o.polygon?.length >= 3).map((o) => o.polygon);
  fills.set(polygons);
  outlines.records.clear();
  for (const polygon of polygons) outlines.addLoop(polygon, 1, theme['obstacle-rim'], 1);
  outlines.upload();
  circles.records.clear();
  for (const { circle } of scene.obstacles) {
    if (!circle) continue;
    circles.addCircle(circle[0], circle[1], circle[2],
      { fill: theme.obstacle, fillAlpha: 1, stroke: theme['obstacle-rim'], strokeAlpha: 1, width: 1 });
  }
  circles.upload();
}

/** Legs as wide as their mass, nodes as their one-sigma ellipse. */
export function showPlan(scene, theme, legs, nodes) {
  legs.records.clear();
  nodes.records.clear();
  if (scene.plan) {
    const most = Math.max(...scene.plan.legs.map((leg) => leg[2]), 1e-12);
    for (const [from, to, mass] of scene.plan.legs) {
      legs.add(scene.plan.nodes[from].mean, scene.plan.nodes[to].mean, 0.8 + 7 * Math.sqrt(mass / most), theme.leg, 0.13);
    }
    for (const { mean, cov, mass } of scene.plan.nodes) {
      if (mass === 0) continue;
      nodes.addGaussian(...mean, ...cov, 1, { stroke: theme.leg, strokeAlpha: 0.16, width: 1 });
    }
  }
  legs.upload();
  nodes.upload();
}

/** Start and goal of the swarm. */
export function showRegions(scene, theme, regions) {
  regions.records.clear();
  const add = (parts, look) => {
    // A shape made of hundreds of components would be all rims: they stay faint together.
    const faint = parts.length > 12 ? 0.3 : 1;
    parts.forEach(({ mean, cov }, i) => {
      const { colour, dash } = look(i);
      regions.addGaussian(...mean, ...cov, SIGMAS_99,
        { fill: colour, fillAlpha: 0.06 * faint, stroke: colour, strokeAlpha: 0.75 * faint, width: 1.2, dash });
      regions.addGaussian(...mean, ...cov, 1,
        { fill: colour, fillAlpha: 0.07 * faint, stroke: colour, strokeAlpha: 0.5 * faint, width: 1, dash });
    });
  };
  add(scene.start, () => ({ colour: theme.start, dash: 4 }));
  add(scene.goal, (i) => ({ colour: theme.goals[i % 8], dash: 0 }));
  regions.upload();
}

/** The planned mixture at the frame's time. */
export function showMixture(viewFrame, theme, mixture) {
  mixture.records.clear();
  let most = 1e-12;
  for (let i = 0; i < viewFrame.m; ++i) most = Math.max(most, viewFrame.mixture[6 * i + 5]);
  for (let i = 0; i < viewFrame.m; ++i) {
    const [x, y, xx, xy, yy, weight] = viewFrame.mixture.subarray(6 * i, 6 * i + 6);
    if (weight <= 0) continue;
    const strength = 0.35 + 0.65 * Math.sqrt(weight / most);
    mixture.addGaussian(x, y, xx, xy, yy, SIGMAS_99,
      { fill: theme.mixture, fillAlpha: 0.05 * strength, stroke: theme.mixture, strokeAlpha: 0.22 * strength, width: 1 });
    mixture.addGaussian(x, y, xx, xy, yy, 1,
      { fill: theme.mixture, fillAlpha: 0.07 * strength, stroke: theme.mixture, strokeAlpha: 0.6 * strength, width: 1.2 });
  }
  mixture.upload();
}

/** `chosen`: null or {x, y, held, estimates}; estimates: three floats per neighbour, of which the last two are x and y. */
export function showChosen(chosen, scene, camera, theme, lines, rings) {
  lines.records.clear();
  rings.records.clear();
  if (chosen) {
    const { x, y, held, estimates } = chosen;
    const arm = 4.5 / camera.scale;
    for (let i = 0; i + 2 < estimates.length; i += 3) {
      const bx = estimates[i + 1], by = estimates[i + 2];
      lines.add([x, y], [bx, by], 1, theme.chosen, 0.45);
      lines.add([bx - arm, by - arm], [bx + arm, by + arm], 1.5, theme.chosen, 1);
      lines.add([bx - arm, by + arm], [bx + arm, by - arm], 1.5, theme.chosen, 1);
    }
    const radius_m = Math.max(scene.radius_m, 3 / camera.scale);
    if (scene.hearing_m) {
      rings.addCircle(x, y, scene.hearing_m,
        { fill: theme.chosen, fillAlpha: 0.04, stroke: theme.chosen, strokeAlpha: 0.7, width: 1.2, dash: 5 });
    }
    rings.addCircle(x, y, radius_m + 3.5 / camera.scale,
      { stroke: theme.chosen, strokeAlpha: held ? 1 : 0.7, width: held ? 2.2 : 1.4 });
  }
  lines.upload();
  rings.upload();
}
