// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Robots as ROS 2 knows them, by others' DDS and messages: a command topic in, a pose topic out, and a watchdog.
//   node robots.mjs DOMAIN KIND@X,Y,YAW [KIND@X,Y,YAW …]
// They are /r0, /r1, … KIND is a preset of the driver. Those that fly have taken off. Ends on SIGTERM, with a line of JSON
// about each robot.
import { now, RosNode } from "./ros_node.mjs";

const kStep_s = 0.02;
const kSpeed_mps = 0.6;
const kAcceleration_mps2 = 1.5;
const kTurn_radps = 2.5;
const kWatchdog_s = 0.5;
const kHeight_m = 1;
const kMost_s = 300;

const clamp = (x, most) => Math.max(-most, Math.min(most, x));
const number = (x) => (Number.isFinite(x) ? x : 0);

// How each kind is commanded: to [forwards, sideways, up, turn], those of a base in its own frame.
const base = ({ linear, angular }) => [linear.x, 0, 0, angular.z];
const kKinds = {
  base: { topic: "cmd_vel", type: "geometry_msgs/Twist", wanted: base },
  base_stamped: { topic: "cmd_vel", type: "geometry_msgs/TwistStamped", wanted: (m) => base(m.twist) },
  omni: {
    topic: "cmd_vel",
    type: "geometry_msgs/Twist",
    wanted: ({ linear, angular }) => [linear.x, linear.y, 0, angular.z],
  },
  crazyswarm2: {
    topic: "cmd_velocity_world",
    type: "crazyflie_interfaces/VelocityWorld",
    pose: "pose",
    wanted: ({ vel, yaw_rate }) => [vel.x, vel.y, vel.z, yaw_rate],
  },
  ardupilot: {
    topic: "ap/cmd_vel",
    type: "geometry_msgs/TwistStamped",
    pose: "ap/pose/filtered",
    frame: "map",
    wanted: ({ twist: { linear, angular } }) => [linear.x, linear.y, linear.z, angular.z],
  },
};

class Robot {
  constructor(node, name, kind, [x, y, yaw]) {
    const { topic, type, pose } = kKinds[kind];
    const z = pose === undefined ? 0 : kHeight_m;
    Object.assign(this, { name, kind, x, y, z, yaw, v: [0, 0, 0], wanted: [0, 0, 0, 0] });
    Object.assign(this, { commands: 0, last: 1, wrong_frame: 0, gap_s: 0, path_m: 0 });
    node.subscribe(`/${name}/${topic}`, type, (message) => this.command(message));
    this.publish = node.advertise(
      `/${name}/${pose ?? "odom"}`,
      pose === undefined ? "nav_msgs/Odometry" : "geometry_msgs/PoseStamped",
    );
  }
  command(message) {
    const { wanted, frame } = kKinds[this.kind];
    if (frame !== undefined && message.header.frame_id !== frame) ++this.wrong_frame;
    const at = performance.now() / 1000;
    if (this.commands > 0) this.gap_s = Math.max(this.gap_s, at - this.commanded_s);
    this.commanded_s = at;
    ++this.commands;
    this.wanted = wanted(message).map(number);
    this.last = Math.hypot(...this.wanted.slice(0, 2));
  }
  step() {
    if (!(performance.now() / 1000 - this.commanded_s < kWatchdog_s)) this.wanted = [0, 0, 0, 0];
    const most = kAcceleration_mps2 * kStep_s;
    this.v = this.v.map((v, i) => v + clamp(clamp(this.wanted[i], kSpeed_mps) - v, most));
    this.yaw += clamp(this.wanted[3], kTurn_radps) * kStep_s;
    // In the frame of the robot, or of the world.
    const angle = kKinds[this.kind].pose === undefined ? this.yaw : 0;
    const [x, y, z] = this.v;
    this.x += (x * Math.cos(angle) - y * Math.sin(angle)) * kStep_s;
    this.y += (x * Math.sin(angle) + y * Math.cos(angle)) * kStep_s;
    this.z += z * kStep_s;
    this.path_m += Math.hypot(x, y) * kStep_s;
  }
  report() {
    const pose = {
      position: { x: this.x, y: this.y, z: this.z },
      orientation: { x: 0, y: 0, z: Math.sin(this.yaw / 2), w: Math.cos(this.yaw / 2) },
    };
    if (kKinds[this.kind].pose !== undefined) {
      this.publish({ header: { stamp: now(), frame_id: "world" }, pose });
      return;
    }
    const covariance = new Float64Array(36);
    const twist = {
      linear: { x: this.v[0], y: this.v[1], z: 0 },
      angular: { x: 0, y: 0, z: this.wanted[3] },
    };
    this.publish({
      header: { stamp: now(), frame_id: `${this.name}/odom` },
      child_frame_id: `${this.name}/base_link`,
      pose: { pose, covariance },
      twist: { twist, covariance },
    });
  }
}

const [domain, ...robots] = process.argv.slice(2);
const node = new RosNode("robots", Number(domain));
await node.start();
const all = robots.map((text, i) => {
  const [kind, place] = text.split("@");
  return new Robot(node, `r${i}`, kind, place.split(",").map(Number));
});
const began = performance.now();
let steps = 0;
const timer = setInterval(() => {
  for (; steps * kStep_s < (performance.now() - began) / 1000; ++steps) for (const robot of all) robot.step();
  for (const robot of all) robot.report();
}, 1000 * kStep_s);

async function end() {
  await new Promise((resolve) => setTimeout(resolve, 1000)); // the watchdog stops what still moves
  clearInterval(timer);
  for (const { publish, wanted, ...robot } of all) console.log(JSON.stringify(robot));
  await node.stop();
  process.exit(0);
}
process.on("SIGTERM", end);
setTimeout(end, 1000 * kMost_s);
