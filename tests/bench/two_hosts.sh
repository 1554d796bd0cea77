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
echo "runs in $out" >&2
failed=0
# shellcheck source=tests/bench/host_pair.sh
. "$root/tests/bench/host_pair.sh"

clean() {
  # shellcheck disable=SC2086
  kill $launcher $joined 2>/dev/null || true
  remove_hosts
}
trap clean EXIT
trap 'exit 130' INT TERM

make_hosts "$out" 0.05 20

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
  fly_on_both "$mission" "$out/$case"
  if [ "$case" = cut ]; then
    await_start "$out/$case"
    sleep 60
    echo 1 >&3
    sleep 10
    echo 0.05 >&3
  fi
  finish "$case"
done
exit "$failed"
