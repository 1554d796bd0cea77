// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The facts about the robot under the pointer or the chosen one.
import { byId, clock, put } from './text.js';

const WINDOW_S = 0.6;  // speed is estimated over about this long

export class RobotPanel {
  #id = null;
  #past = [];  // [t, x, y]

  /** A frame of another time. */
  observe(robot, t) {
    if (robot === null) return;
    if (robot.id !== this.#id || t < (this.#past.at(-1)?.[0] ?? t)) this.#past = [];
    this.#id = robot.id;
    if (t === this.#past.at(-1)?.[0]) return;
    this.#past.push([t, robot.x, robot.y]);
    while (this.#past.length > 2 && this.#past[1][0] < t - WINDOW_S) this.#past.shift();
  }

  #speed() {
    const [first, last] = [this.#past[0], this.#past.at(-1)];
    if (this.#past.length < 2 || last[0] - first[0] > 5 * WINDOW_S) return null;
    return Math.hypot(last[1] - first[1], last[2] - first[2]) / (last[0] - first[0]);
  }

  show(robot, held, viewFrame) {
    byId('robot-none').hidden = robot !== null;
    byId('robot-facts').hidden = robot === null;
    if (robot === null) return put(byId('robot-title'), 'Robot');
    put(byId('robot-title'), `Robot ${robot.id}${held ? '' : ' (under the pointer)'}`);
    const speed = robot.id === this.#id ? this.#speed() : null;
    const put_fact = (name, text) => put(byId(`robot-${name}`), text);
    put_fact('mode', robot.lost ? `${robot.mode}, lost` : robot.received ? robot.mode : 'not received');
    put_fact('goal', robot.goal === null ? 'none' : String(robot.goal));
    put_fact('position', `${robot.x.toFixed(2)}, ${robot.y.toFixed(2)} m`);
    put_fact('heading', `${Math.round(robot.heading * 180 / Math.PI)}°`);
    put_fact('speed', speed === null ? '–' : `${speed.toFixed(2)} m/s`);
    put_fact('neighbours', robot.neighbours === 255 ? '255 or more' : String(robot.neighbours));
    put_fact('error', viewFrame.focus === robot.id ? worstEstimate(viewFrame) : '–');
    put_fact('time', clock(viewFrame.t));
  }
}

/** The largest distance between an estimated neighbour and its position in the same frame. */
function worstEstimate(viewFrame) {
  let worst = -1, who = 0;
  for (let i = 0; i < viewFrame.k; ++i) {
    const id = viewFrame.estimated[3 * i];
    if (id >= viewFrame.n) continue;
    const off = Math.hypot(viewFrame.estimates[3 * i + 1] - viewFrame.robots[4 * id],
      viewFrame.estimates[3 * i + 2] - viewFrame.robots[4 * id + 1]);
    if (off > worst) [worst, who] = [off, id];
  }
  return worst < 0 ? 'no neighbours' : `${worst.toFixed(2)} m (robot ${who})`;
}
