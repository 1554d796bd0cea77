// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Judges a flight by the launcher's summary and by what the robots themselves counted:
//   node judge_flight.mjs SUMMARY.json ROBOTS.json
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";

const [summary, robots] = process.argv.slice(2).map((file) => readFileSync(file, "utf8").trim());
const flight = JSON.parse(summary);
const counted = robots.split("\n").map((line) => JSON.parse(line));
assert.equal(flight.outcome, "ok");
assert.equal(flight.arrived, counted.length);
assert.equal(flight.collisions_robot + flight.collisions_obstacle, 0);
for (const robot of counted) {
  // Ten a second are due. A machine with other work misses some.
  assert.ok(robot.commands > 3 * flight.mission_s, `${robot.name} got ${robot.commands} commands`);
  assert.ok(robot.path_m > 6, `${robot.name} moved ${robot.path_m} m`);
  assert.equal(robot.last, 0, `the last command of ${robot.name} is not to stop`);
  assert.ok(Math.hypot(...robot.v) < 0.01, `${robot.name} still moves`);
  assert.equal(robot.wrong_frame, 0, `${robot.name} is commanded in another frame`);
  if (robot.kind === "crazyswarm2") assert.ok(Math.abs(robot.z - 1.2) < 0.05, `${robot.name} is at ${robot.z} m`);
}
console.log(`${counted.length} arrived in ${flight.mission_s} s, least gap ${flight.min_robot_gap_m} m`);
