#!/bin/sh
# What looking on costs: flies the stand-in mission with a recorder and a view, to which somebody looks at 20 pictures a
# second, and prints the share of one core that both take over a minute, and what the recorder missed. Needs jq and
# Node.js with the packages of tests/browser.   tests/bench/watching.sh [ROBOTS]      (default: 200)
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
bin=${SWARM_BIN:-$root/build/release/bin}
robots=${1:-200}
seconds=60
run=$(mktemp -d)/run
echo "run in $run" >&2
"$bin/swarm_launcher" run "$root/deploy/missions/swarmprm_standin.yaml" --robots "$robots" --channel groups --record --view \
  --out "$run" --json >/dev/null 2>"$run.log" &
launcher=$!
trap 'kill "$launcher" 2>/dev/null || true' EXIT
until grep -qs '"text":"start"' "$run/events.jsonl"; do
  kill -0 "$launcher"
  sleep 0.2
done
sleep 5
url=$(head -n 1 "$run/logs/view.log")

# ticks NAME: CPU of the children with this command line
ticks() {
  for pid in $(pgrep -P "$launcher" -f "swarm_monitor $1"); do
    awk '{ print $14 + $15 }' "/proc/$pid/stat"
  done | awk '{ sum += $1 } END { print sum + 0 }'
}

record_before=$(ticks record)
view_before=$(ticks view)
(cd "$root/tests/browser" && node pictures.mjs "$url" "$seconds" 20)
hz=$(getconf CLK_TCK)
awk -v r="$(($(ticks record) - record_before))" -v v="$(($(ticks view) - view_before))" -v hz="$hz" -v s="$seconds" \
  'BEGIN { printf "record %.1f %%, view %.1f %%, both %.1f %% of one core\n", 100 * r / hz / s, 100 * v / hz / s, 100 * (r + v) / hz / s }'
curl -s "${url%%#*}metrics" | grep -E '^swarm_(states_lost|messages_refused)'
wait "$launcher" || true
jq -c '{messages, dropped_by_disk, states}' "$run/logs/record.log"
jq -c '{robots, arrived, collisions_robot, deadline_miss_ratio, outcome}' "$run/summary.json"
