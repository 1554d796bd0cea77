#!/bin/sh
# The figures of docs/BENCHMARKS.md that need a hundred processes and real faults: too long for the test suite.
# One JSON-ish line a case on stdout. About half an hour.   tests/bench/must_hold.sh [CASE …]
#   cases: plan seeds more replan lost planner stop interrupt restarts      (default: all)
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
bin=${SWARM_BIN:-$root/build/release/bin}
mission=$root/deploy/missions/swarmprm_standin.yaml
out=$(mktemp -d)
echo "runs in $out" >&2

# report NAME EXIT: the interesting keys of a run's summary on one line
report() {
  printf '%s exit=%s ' "$1" "$2"
  tr -d '\n' <"$out/$1/summary.json" | tr -s ' ' |
    grep -oE '"(outcome|arrived|lost|collisions_robot|collisions_obstacle|min_robot_gap_m|path_ratio|mission_s|stop_latency_ms|belief_error_cm|states_hz|deadline_miss_ratio|discovery_s|plan_ms|cpu_s)": ([^,[{]+|\[[^]]*\]|\{[^}]*\})' |
    tr '\n' ' '
  echo
}

# fly NAME [OPTIONS …]: a run in the foreground
fly() {
  name=$1
  shift
  code=0
  "$bin/swarm_launcher" run "$mission" --out "$out/$name" --json "$@" >/dev/null 2>"$out/$name.log" || code=$?
  report "$name" "$code"
}

# start NAME SECONDS [OPTIONS …]: a run in the background, until its mission has started and SECONDS have passed
start() {
  name=$1
  seconds=$2
  shift 2
  "$bin/swarm_launcher" run "$mission" --out "$out/$name" --json "$@" >/dev/null 2>"$out/$name.log" &
  launcher=$!
  until grep -qs '"text":"start"' "$out/$name/events.jsonl"; do sleep 0.2; done
  sleep "$seconds"
}

# finish NAME: waits for it
finish() {
  code=0
  wait "$launcher" || code=$?
  report "$1" "$code"
}

children() { pgrep -P "$launcher" -x "$1"; }

for case in ${*:-plan seeds more replan lost planner stop interrupt restarts}; do
  case $case in
    plan) "$bin/swarm_launcher" plan "$mission" --repeat 31 ;;
    seeds) for seed in 1 2 3 4 5; do fly "seed$seed" --seed "$seed"; done ;;
    more) fly more --robots 120 ;;
    replan) # two obstacles dropped on the main route in mid-flight
      start replan 30
      "$bin/swarm_launcher" command "$out/replan" add_obstacle 'circle_m: {center: [100, 50], radius: 5}'
      sleep 35
      "$bin/swarm_launcher" command "$out/replan" add_obstacle 'circle_m: {center: [128, 58], radius: 4}'
      finish replan
      grep -o '"version [0-9]*: .*after the change"' "$out/replan/events.jsonl"
      ;;
    lost)
      start lost 60
      children robot_agent | sed -n '11p;31p;51p;71p;91p' | xargs kill -9
      finish lost
      ;;
    planner)
      start planner 60
      children planner_service | xargs kill -9
      finish planner
      ;;
    stop)
      start stop 60
      children planner_service | xargs kill -9
      "$bin/swarm_launcher" command "$out/stop" stop
      finish stop
      ;;
    interrupt)
      for after in 0.3 1.5 4 20; do
        "$bin/swarm_launcher" run "$mission" --out "$out/interrupt$after" --json >/dev/null 2>&1 &
        launcher=$!
        sleep "$after"
        begin=$(date +%s%N)
        kill -INT "$launcher"
        code=0
        wait "$launcher" || code=$?
        left=$(pgrep -cf "$out/interrupt$after" || true)
        echo "interrupt after ${after} s: gone in $((($(date +%s%N) - begin) / 1000000)) ms, exit=$code," \
          "left=$left, $(grep -o '"outcome": "[a-z_]*"' "$out/interrupt$after/summary.json")"
      done
      ;;
    restarts) # planner, agents and gateway killed one by one, every one of them comes back
      { cat "$mission" && printf 'launcher:\n  respawn_agent_max: 3\n  respawn_planner_max: 9\n'; } >"$out/restarts.yaml"
      mission=$out/restarts.yaml start restarts 20 --channel groups --by-gateway 5
      for robot in 11 31 51 71 91; do
        children planner_service | xargs kill -9
        sleep 8
        children robot_agent | sed -n "${robot}p" | xargs kill -9
        sleep 4
        children swarm_launcher | xargs kill -9
        sleep 4
      done
      finish restarts
      awk '{ match($0, /[0-9]+/); t = substr($0, RSTART, RLENGTH) / 1e9 }
        /"(agent|planner|gateway)-exit"/ { exits++; gone = t }
        /"planner-silent"/ { silent++ }
        /"planner-heard"/ && gone && t - gone < 8 && t - gone > back { back = t - gone }
        END { printf "restarts: %d, back after %.2f s at most, robots that missed the planner: %d\n", exits, back, silent }' \
        "$out/restarts/events.jsonl"
      ;;
    *)
      echo "unknown case $case" >&2
      exit 3
      ;;
  esac
done
