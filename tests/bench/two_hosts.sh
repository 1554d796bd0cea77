#!/bin/sh
# One mission by two hosts, each a network namespace of this machine, with 5 % loss and 20 ms of delay between them; as root.
# Needs iproute2, jq and python3.
# One JSON line a case on stdout. About eight minutes.   tests/bench/two_hosts.sh [CASE …]
#   cases: lossy cut      (default: both; cut: the link is cut for 10 s in mid-flight)
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
bin=${SWARM_BIN:-$root/build/release/bin}
mission=$root/deploy/missions/swarmprm_standin.yaml
robots=${ROBOTS:-100}
out=$(mktemp -d)
a=swarmflow-a-$$
b=swarmflow-b-$$
echo "runs in $out" >&2

launcher=
joined=
failed=0

clean() {
  exec 3>&-
  # shellcheck disable=SC2086
  kill $launcher $joined 2>/dev/null || true
  ip netns del "$a" 2>/dev/null || true
  ip netns del "$b" 2>/dev/null || true
}
trap clean EXIT
trap 'exit 130' INT TERM

# host NAMESPACE INTERFACE ADDRESS
host() {
  ip -n "$1" link set lo up
  ip -n "$1" addr add "$3/24" dev "$2"
  ip -n "$1" link set "$2" up
}

ip netns add "$a"
ip netns add "$b"
mkfifo "$out/loss" "$out/ready"
"$root/tests/bench/lossy_cable.py" "$a" cable-a "$b" cable-b 0.05 20 <"$out/loss" >"$out/ready" &
exec 3>"$out/loss" # the cable ends when this is closed
read -r _ <"$out/ready"
host "$a" cable-a 10.77.0.1
host "$b" cable-b 10.77.0.2

# fly NAME: half of the robots on each host, in the background
fly() {
  ip netns exec "$a" "$bin/swarm_launcher" run "$mission" --robots "$robots" --out "$out/$1" --json \
    --interface 10.77.0.1 --remote $((robots / 2)) --join-port 7000 >/dev/null 2>"$out/$1.log" &
  launcher=$!
  until grep -qs 'swarm_launcher join' "$out/$1.log"; do
    kill -0 "$launcher"
    sleep 0.2
  done
  ip netns exec "$b" "$bin/swarm_launcher" join 10.77.0.1:7000 --robots $((robots / 2)) --out "$out/$1-b" \
    2>"$out/$1-b.log" &
  joined=$!
}

# finish NAME
finish() {
  code=0
  wait "$launcher" || code=$?
  joined_code=0
  wait "$joined" || joined_code=$?
  [ "$code$joined_code" = 00 ] || failed=1
  jq -c --arg name "$1" --argjson exit "[$code, $joined_code]" '{name: $name, exit: $exit, arrived, lost, collisions_robot,
    collisions_obstacle, min_robot_gap_m, path_ratio, mission_s, discovery_s, states_hz, state_age_ms, belief_error_cm}' \
    "$out/$1/summary.json"
  grep -E '"host-(joined|silent|back|over)"|boxes-missing' "$out/$1/events.jsonl" >&2 || true
}

for case in ${*:-lossy cut}; do
  fly "$case"
  if [ "$case" = cut ]; then
    until grep -qs '"text":"start"' "$out/$case/events.jsonl"; do
      kill -0 "$launcher"
      sleep 0.2
    done
    sleep 60
    echo 1 >&3
    sleep 10
    echo 0.05 >&3
  fi
  finish "$case"
done
exit "$failed"
