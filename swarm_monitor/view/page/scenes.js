// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// All scenes so far, and which of them holds when.

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
