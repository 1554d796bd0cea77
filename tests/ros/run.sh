#!/bin/sh
# ROS 2 by programs that are not ours: messages by their official definitions, and robots by another DDS, flown with both
# vendors while Wireshark, with root, reads the names of topics and types. Needs Node.js with npm, and tshark; about three
# minutes.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
SWARM_BIN=$(cd "${SWARM_BIN:-$root/build/release/bin}" && pwd)
export SWARM_BIN
tmp=$(mktemp -d)
robots=
tshark=
watch=
publisher=
launcher=
trap '[ -z "$robots$tshark$watch$publisher$launcher" ] ||
  kill $robots $tshark $watch $publisher $launcher 2>/dev/null || true; rm -rf "$tmp"' EXIT
trap 'exit 130' INT TERM

cd "$here"
if [ -z "$(find node_modules/.package-lock.json -newer package-lock.json 2>/dev/null)" ]; then
  # Without the registry there is nothing to test with: ctest takes 77 for skipped.
  npm ci --no-audit --no-fund --ignore-scripts >"$tmp/npm.log" 2>&1 || { cat "$tmp/npm.log" >&2; exit 77; }
  touch node_modules/.package-lock.json
fi
node --test --test-reporter spec wire_test.mjs

# start_robots KIND@X,Y,YAW …
start_robots() {
  node robots.mjs "$ROS_DOMAIN_ID" "$@" >"$tmp/robots.json" &
  robots=$!
}
end_robots() {
  kill "$robots"
  wait "$robots" || true
  robots=
}

# start_watch [STOP_AFTER_S]: another node, which receives what is published about the swarm
start_watch() {
  node watch_swarm.mjs "$ROS_DOMAIN_ID" "$@" >"$tmp/watch.json" 2>"$tmp/watch.log" &
  watch=$!
}
end_watch() {
  kill "$watch"
  wait "$watch" || true
  watch=
}

# publish RUN LAUNCHER: to ROS, from when the robots fly until the end of the run
publish() {
  until grep -qs '"text":"start"' "$1/events.jsonl"; do
    kill -0 "$2" || { cat "$1.log" >&2; exit 1; }
    sleep 0.1
  done
  "$SWARM_BIN/swarm_monitor" ros "$1" &
  publisher=$!
}

# start_capture FILE: all datagrams on loopback
start_capture() {
  tshark -q -i lo -f udp -a duration:300 -w "$1" 2>"$tmp/tshark.log" &
  tshark=$!
  until grep -qs 'Capture started' "$tmp/tshark.log"; do
    kill -0 "$tshark" || { cat "$tmp/tshark.log" >&2; exit 1; }
    sleep 0.1
  done
}

# fly VENDOR: a robot of each kind
fly() {
  export RMW_IMPLEMENTATION="$1"
  echo "== $1"
  [ "$(id -u)" -ne 0 ] || start_capture "$tmp/$1.pcapng"
  start_robots base@2,1,0 base_stamped@2,2.3,1.5 omni@2,3.6,-1.5 crazyswarm2@2,4.9,3 ardupilot@2,6.2,0
  start_watch
  code=0
  "$SWARM_BIN/swarm_launcher" run mixed.yaml --json --out "$tmp/$1" >"$tmp/$1.json" 2>"$tmp/$1.log" &
  launcher=$!
  publish "$tmp/$1" "$launcher"
  # The map is published anew.
  until grep -q PoseArray "$tmp/watch.log"; do
    kill -0 "$launcher" || { cat "$tmp/watch.log" "$tmp/$1.log" >&2; exit 1; }
    sleep 0.1
  done
  "$SWARM_BIN/swarm_launcher" command "$tmp/$1" add_obstacle 'circle_m: {center: [6, 0.2], radius: 0.2}'
  wait "$launcher" || code=$?
  launcher=
  wait "$publisher"
  publisher=
  end_watch
  end_robots
  [ -z "$tshark" ] || { kill "$tshark"; wait "$tshark" || true; }
  tshark=
  cat "$tmp/robots.json"
  [ "$code" -eq 0 ] || { cat "$tmp/$1.log" "$tmp/$1.json" >&2; exit 1; }
  node judge_flight.mjs "$tmp/$1.json" "$tmp/robots.json"
  node judge_watch.mjs "$tmp/watch.json" "$tmp/robots.json"
  [ -e "$tmp/$1.pcapng" ] || { echo "names on the wire: not read, as that needs root"; return 0; }
  # Lists of names and of types, in the same order.
  tshark -r "$tmp/$1.pcapng" -Y 'rtps.param.topicName contains "rt/r"' -T fields \
    -e rtps.param.topicName -e rtps.param.typeName 2>/dev/null | awk -F '\t' '
      { n = split($1, topics, ","); split($2, types, ","); for (i = 1; i <= n; ++i) print topics[i], types[i] }' |
    sort -u >"$tmp/names"
  for expected in 'r0/cmd_vel geometry_msgs/Twist' 'r1/cmd_vel geometry_msgs/TwistStamped' \
    'r1/odom nav_msgs/Odometry' 'r2/battery_state sensor_msgs/BatteryState' \
    'r3/cmd_velocity_world crazyflie_interfaces/VelocityWorld' 'r3/pose geometry_msgs/PoseStamped' \
    'r4/ap/cmd_vel geometry_msgs/TwistStamped'; do
    name="rt/$(echo "$expected" | sed 's|/\([^/]*\)$|::msg::dds_::\1_|')"
    grep -qx "$name" "$tmp/names" || { echo "tshark saw no $name" >&2; cat "$tmp/names" >&2; exit 1; }
    echo "on the wire: $name"
  done
}

export ROS_DOMAIN_ID=$((60 + $$ % 40)) ROS_LOCALHOST_ONLY=1
fly rmw_fastrtps_cpp
fly rmw_cyclonedds_cpp

# Simulated robots, stopped by a node of ROS.
echo "== emergency stop"
start_watch 3
code=0
"$SWARM_BIN/swarm_launcher" run "$root/deploy/missions/small.yaml" --json --out "$tmp/stop" >"$tmp/stop.json" \
  2>"$tmp/stop.log" &
launcher=$!
publish "$tmp/stop" "$launcher"
wait "$launcher" || code=$?
launcher=
wait "$publisher"
publisher=
end_watch
grep -q '"outcome": "stopped"' "$tmp/stop.json" || { cat "$tmp/stop.log" "$tmp/stop.json" >&2; exit 1; }
echo "stopped, exit code $code"

# The check starts its driver twice. Fast DDS adds a parameter to what the second participant of a process announces, with
# which that library does not find it: so this runs with the other vendor.
echo "== check-driver"
start_robots base@2,1.5,0
"$SWARM_BIN/swarm_launcher" check-driver "$root/deploy/missions/ros_bases.yaml"
end_robots
echo "all passed"
