// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// All scenes so far, and which of them holds when.

/** A scene whose lengths are relative to its origin, as those of frames are: the graphics compute in floats. */
export function toLocal(scene) {
  const origin = scene.origin ?? [0, 0];
  const moved = ([x, y]) => [x - origin[0], y - origin[1]];
  const parts = (list) => list.map((part) => ({ ...part, mean: moved(part.mean) }));
  return {
    ...scene, origin,
    bounds: scene.bounds.map(moved),
    obstacles: scene.obstacles.map((o) => ({
      ...o,
      ...(o.polygon ? { polygon: o.polygon.map(moved) } : {}),
      ...(o.circle ? { circle: [...moved(o.circle), o.circle[2]] } : {}),
    })),
    start: parts(scene.start), goal: parts(scene.goal),
    plan: scene.plan ? { ...scene.plan, nodes: parts(scene.plan.nodes) } : null,
  };
}

export class Scenes {
  #list = [];

  clear() {
    this.#list = [];
  }

  add(scene) {
    let at = this.#list.length;
    while (at > 0 && this.#list[at - 1].t > scene.t) at -= 1;
    this.#list.splice(at, 0, scene);
  }

  /** The last scene that holds from `t` or before; before the first one, the first. */
  at(t) {
    for (let i = this.#list.length - 1; i > 0; --i) {
      if (this.#list[i].t <= t) return this.#list[i];
    }
    return this.#list[0] ?? null;
  }

  newest() {
    return this.#list.at(-1) ?? null;
  }
}
