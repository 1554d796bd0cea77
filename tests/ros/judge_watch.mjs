// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Compares what was published to ROS with where the robots were at the end:
//   node judge_watch.mjs WATCH.json ROBOTS.json
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";

const [watch, robots] = process.argv.slice(2).map((file) => readFileSync(file, "utf8").trim());
const seen = JSON.parse(watch);
const counted = robots.split("\n").map((line) => JSON.parse(line));
const counts = Object.entries(seen).map(([topic, { count }]) => `${topic} ${count}`);
console.log(counts.join(", "));

// Half a minute at 10 and 1 Hz; a machine with other work loses some.
assert.ok(seen["/swarm/poses"].count > 100 && seen["/swarm/markers"].count > 100);
assert.ok(seen["/diagnostics"].count > 10 && seen["/swarm/map"].count >= 1);

const { header, poses } = seen["/swarm/poses"].last;
assert.equal(header.frame_id, "map");
assert.equal(poses.length, counted.length);
poses.forEach(({ position }, i) => {
  const off_m = Math.hypot(position.x - counted[i].x, position.y - counted[i].y);
  assert.ok(off_m < 0.3, `robot ${i} is ${off_m} m off`);
});

const { markers } = seen["/swarm/markers"].last;
assert.equal(markers[0].points.length, counted.length);
assert.ok(markers.length > 1, "no ellipse of the plan");

const { info, data } = seen["/swarm/map"].last;
assert.equal(data.length, info.width * info.height);
const cell = (x, y) => data[Math.floor(y / info.resolution) * info.width + Math.floor(x / info.resolution)];
assert.equal(cell(6, 3.75), 100, "the table");
assert.equal(cell(6, 1), 0, "the floor");
assert.equal(cell(6, 0.15), 100, "the obstacle that was added");

const { status } = seen["/diagnostics"].last;
assert.equal(status.length, counted.length + 1);
assert.ok(status.some(({ name, level }) => name === "swarmflow: robot 0" && level === 0));
