// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A frame as PROTOCOL.md defines it: views into the received bytes, nothing is copied.

export const HEADER_BYTES = 24;
export const ROBOT_BYTES = 16;
export const PHASES = ['ready', 'running', 'paused', 'stopped', 'ended'];
export const MODES = ['waiting', 'moving', 'holding', 'arrived', 'stopped'];
export const RECEIVED = 1, ARRIVED = 2, LOST = 4;
const NO_ROBOT = 0xFFFFFFFF;
const MAGIC = 0x31465753;  // "SWF1"

/** Throws if the bytes are not a frame. */
export function decode(buffer) {
  const view = new DataView(buffer);
  if (buffer.byteLength < HEADER_BYTES || view.getUint32(0, true) !== MAGIC) throw new Error('not a frame');
  const n = view.getUint32(4, true);
  const m = view.getUint32(20, true);
  const mixtureAt = HEADER_BYTES + ROBOT_BYTES * n;
  const focusAt = mixtureAt + 24 * m;
  if (buffer.byteLength < focusAt + 8) throw new Error('a truncated frame');
  const k = view.getUint32(focusAt + 4, true);
  if (buffer.byteLength !== focusAt + 8 + 12 * k) throw new Error('a frame of a wrong length');
  const focus = view.getUint32(focusAt, true);
  return {
    buffer, n, m, k,
    t: view.getFloat64(8, true),
    phase: PHASES[view.getUint32(16, true)] ?? 'unknown',
    robots: new Float32Array(buffer, HEADER_BYTES, 4 * n),  // x, y, heading, -
    info: new Uint8Array(buffer, HEADER_BYTES, ROBOT_BYTES * n),  // bytes 12 to 15: mode, goal, flags, neighbours
    mixture: new Float32Array(buffer, mixtureAt, 6 * m),
    focus: focus === NO_ROBOT ? null : focus,
    estimates: new Float32Array(buffer, focusAt + 8, 3 * k),  // -, x, y
    estimated: new Uint32Array(buffer, focusAt + 8, 3 * k),  // neighbour, -, -
  };
}

export function robotOf(viewFrame, id) {
  if (!viewFrame || id === null || id >= viewFrame.n) return null;
  const { robots, info } = viewFrame;
  const at = ROBOT_BYTES * id + 12;
  return {
    id, x: robots[4 * id], y: robots[4 * id + 1], heading: robots[4 * id + 2],
    mode: MODES[info[at]] ?? 'unknown', goal: info[at + 1] === 255 ? null : info[at + 1],
    received: (info[at + 2] & RECEIVED) !== 0, arrived: (info[at + 2] & ARRIVED) !== 0,
    lost: (info[at + 2] & LOST) !== 0, neighbours: info[at + 3],
  };
}

/** Counts of robots by kind; `perGoal` has one entry per goal and a last one for no goal. */
export function countRobots(viewFrame, goals) {
  const counts = { received: 0, moving: 0, arrived: 0, lost: 0, perMode: MODES.map(() => 0), perGoal: new Array(goals + 1).fill(0) };
  for (let at = 12; at < ROBOT_BYTES * viewFrame.n; at += ROBOT_BYTES) {
    const mode = viewFrame.info[at], goal = viewFrame.info[at + 1], flags = viewFrame.info[at + 2];
    if (flags & LOST) counts.lost += 1;
    if (!(flags & RECEIVED)) continue;
    counts.received += 1;
    if (mode === 1) counts.moving += 1;
    if (flags & ARRIVED) counts.arrived += 1;
    if (mode < MODES.length) counts.perMode[mode] += 1;
    counts.perGoal[Math.min(goal, goals)] += 1;
  }
  return counts;
}

/** The robot nearest to a point, at most `within_m` away; null if there is none. */
export function nearestRobot(viewFrame, x, y, within_m) {
  let best = null, least = within_m * within_m;
  for (let i = 0; i < viewFrame.n; ++i) {
    if (!(viewFrame.info[ROBOT_BYTES * i + 14] & (RECEIVED | LOST))) continue;
    const dx = viewFrame.robots[4 * i] - x, dy = viewFrame.robots[4 * i + 1] - y;
    const squared = dx * dx + dy * dy;
    if (squared <= least) {
      least = squared;
      best = i;
    }
  }
  return best;
}
