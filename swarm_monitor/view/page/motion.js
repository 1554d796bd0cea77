// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The last two frames, and the map's time between them: motion stays smooth at few frames per second.

const LONGEST_MS = 250;
const SLOW_FRAME_MS = 40;  // a machine that draws slower shows the newest frame at once

export class Motion {
  before = null;
  now = null;
  #arrived_ms = 0;
  #interval_ms = LONGEST_MS;
  #frame_ms = 16;
  #jumped = true;

  /** Returns {fresh, jumped}: whether the frame is of another time, and whether it does not continue the last one. */
  add(viewFrame, sought, at_ms) {
    const step = this.now ? viewFrame.t - this.now.t : NaN;
    const fresh = step !== 0 || viewFrame.n !== this.now.n;
    const jumped = sought || !(step >= 0 && step < 5) || viewFrame.n !== this.now.n;
    if (fresh) {
      const interval_ms = Math.min(at_ms - this.#arrived_ms, LONGEST_MS);
      this.#interval_ms += 0.2 * (interval_ms - this.#interval_ms);
      this.#arrived_ms = at_ms;
      this.#jumped = jumped;
      this.before = this.now;
    }
    this.now = viewFrame;
    return { fresh, jumped };
  }

  frame(elapsed_ms) {
    this.#frame_ms += 0.1 * (Math.min(elapsed_ms, 200) - this.#frame_ms);
  }

  /** 0: the frame before; 1: the newest. */
  mix(at_ms) {
    if (this.#jumped || this.#frame_ms > SLOW_FRAME_MS) return 1;
    return Math.min((at_ms - this.#arrived_ms) / Math.max(this.#interval_ms, 1), 1);
  }

  /** The position at which a robot of the newest frame is drawn. */
  position(robot, mix) {
    const { before } = this;
    if (mix === 1 || !before || robot.id >= before.n || !(before.info[16 * robot.id + 14] & 5)) return [robot.x, robot.y];
    const at = 4 * robot.id;
    return [before.robots[at] + mix * (robot.x - before.robots[at]),
      before.robots[at + 1] + mix * (robot.y - before.robots[at + 1])];
  }
}
