// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// What `swarm_monitor ros` publishes, as another author's node receives it:
//   node watch_swarm.mjs DOMAIN [STOP_AFTER_S]
// With STOP_AFTER_S it publishes an emergency stop that long after the first poses. Ends on SIGTERM, with the last message
// of each topic and how many there were, as JSON.
import { RosNode } from "./ros_node.mjs";

const kMost_s = 300;
const [domain, stopAfter] = process.argv.slice(2).map(Number);
const node = new RosNode("watch", domain);
const topics = {
  "/swarm/poses": "geometry_msgs/PoseArray",
  "/swarm/markers": "visualization_msgs/MarkerArray",
  "/swarm/map": "nav_msgs/OccupancyGrid",
  "/diagnostics": "diagnostic_msgs/DiagnosticArray",
};
await node.start();
const received = {};
const stop = node.advertise("/swarm/emergency_stop", "std_msgs/Bool");
for (const [topic, type] of Object.entries(topics)) {
  received[topic] = { count: 0 };
  node.subscribe(topic, type, (message) => {
    const seen = received[topic];
    if (topic === "/swarm/poses" && seen.count === 0 && stopAfter > 0) {
      setTimeout(() => stop({ data: true }), 1000 * stopAfter);
    }
    if (seen.count === 0) console.error(`first ${type}`);
    ++seen.count;
    seen.last = message;
  });
}

async function end() {
  // Typed arrays have no JSON of their own.
  const plain = (_, value) => (ArrayBuffer.isView(value) ? [...value] : value);
  console.log(JSON.stringify(received, plain));
  await node.stop();
  process.exit(0);
}
process.on("SIGTERM", end);
setTimeout(end, 1000 * kMost_s);
