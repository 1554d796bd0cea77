// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// What the colours mean, how long a metre is, and the goals' names on the map.
import { MODES } from './view_frame.js';
import { goalVariable } from './theme.js';
import { byId, make, put } from './text.js';

const MOST_GOALS = 12;  // beyond: a shape, whose components mean nothing one by one

export class Legend {
  #key = '';
  #numbers = [];
  #labels = [];

  /** Rebuilt only when what it lists changes; the counts change all the time. */
  update(scene, counts, byMode) {
    const goals = scene.goal.length > MOST_GOALS ? [] : scene.goal;
    const key = JSON.stringify([byMode, goals.map((g) => g.weight)]);
    if (key !== this.#key) {
      this.#key = key;
      const rows = byMode ? MODES.map((name) => [`var(--mode-${name})`, name])
        : [...goals.map((g, i) => [goalVariable(i), `goal ${i}`]), [goalVariable(null), 'no goal yet']];
      this.#numbers = rows.map(() => make('b'));
      byId('legend').replaceChildren(...rows.map(([colour, name], i) => {
        const dot = make('i', { 'aria-hidden': 'true' });
        dot.style.background = colour;
        return make('li', {}, dot, `${name} `, this.#numbers[i]);
      }));
    }
    byId('legend').hidden = !byMode && goals.length === 0;
    const numbers = byMode ? counts.perMode : [...counts.perGoal.slice(0, goals.length), counts.perGoal.at(-1)];
    this.#numbers.forEach((element, i) => {
      put(element, String(numbers[i]));
      element.parentElement.hidden = !byMode && i === goals.length && numbers[i] === 0;
    });
  }

  labels(scene) {
    const total = scene.goal.reduce((sum, g) => sum + g.weight, 0) || 1;
    this.#labels = scene.goal.length > MOST_GOALS ? [] : scene.goal.map(({ mean, cov, weight }, i) => {
      const element = make('span', {}, `${i} · ${Math.round(100 * weight / total)} %`);
      // In the upper part of its ellipse, where robots that arrive do not hide it.
      return { element, at: [mean[0], mean[1] + 2.5 * Math.sqrt(cov[2])] };
    });
    byId('labels').replaceChildren(...this.#labels.map((label) => label.element));
  }

  moved(camera) {
    for (const { element, at } of this.#labels) {
      const [x, y] = camera.toScreen(...at);
      element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -50%)`;
      element.hidden = x < 0 || y < 0 || x > camera.width || y > camera.height;
    }
    const step = camera.roundStep(70);
    byId('scale').style.width = `${(step * camera.scale).toFixed(1)}px`;
    put(byId('scale'), `${Number(step.toPrecision(1))} m`);
  }
}
