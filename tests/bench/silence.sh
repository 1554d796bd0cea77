#!/bin/sh
# Silence in flights of a hundred real processes: agents, launcher, planner and gateway frozen or killed, a host cut off,
# descriptors used up. One JSON line a case and seed on stdout; exit code 1 unless every case has 0 contacts and all living
# robots arrive. Needs jq; `host` needs root, iproute2 and python3. About five minutes a case with both seeds.
#   tests/bench/silence.sh [CASE …]
#   cases: agents narrow launcher server planner gateway descriptors host      (default: all)
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
bin=${SWARM_BIN:-$root/build/release/bin}
missions=$root/deploy/missions
robots=${ROBOTS:-100}
seeds=${SEEDS:-1 2}
out=$(mktemp -d)
echo "runs in $out" >&2
failed=0
# shellcheck source=tests/bench/host_pair.sh
. "$root/tests/bench/host_pair.sh"

clean() {
  # shellcheck disable=SC2086
  kill -CONT $launcher 2>/dev/null || true
  # shellcheck disable=SC2086
  kill $launcher $joined 2>/dev/null || true
  remove_hosts
}
trap clean EXIT
trap 'exit 130' INT TERM

children() { pgrep -P "$launcher" -x "$1"; }

# some NUMBER NAME: that many children of that name, chosen by the seed
some() {
  children "$2" | shuf -n "$1" --random-source="$out/random"
}

# fly MISSION [OPTIONS …]: in the background, until its mission has started
fly() {
  file=$missions/$1
  shift
  "$bin/swarm_launcher" run "$file" --robots "$robots" --seed "$seed" --out "$run" --json "$@" >/dev/null 2>"$run.log" &
  launcher=$!
  await_start "$run"
}

# finish LIVING: waits for it; that many robots are to arrive
finish() {
  code=0
  wait "$launcher" || code=$?
  launcher=
  jq -c --arg case "$case" --argjson seed "$seed" --argjson exit "$code" --argjson living "$1" '{case: $case, seed: $seed,
    exit: $exit, arrived, living: $living, lost, contacts: (.collisions_robot + .collisions_obstacle), min_robot_gap_m, mission_s,
    late: .deadline_miss_ratio, cpu_s} | .holds = (.contacts == 0 and .arrived >= .living)' "$run/summary.json" |
    tee "$run.result"
  grep -q '"holds":true' "$run.result" || failed=1
}

# freeze SECONDS PID …
freeze() {
  seconds=$1
  shift
  kill -STOP "$@"
  sleep "$seconds"
  kill -CONT "$@" 2>/dev/null || true  # it may have been killed meanwhile
}

# The other host is silent for less time than after which it is given up, so all robots are to arrive.
cut_host() {
  mkdir "$run.hosts"
  make_hosts "$run.hosts" 0 5
  fly_on_both "$missions/swarmprm_standin.yaml" "$run" --seed "$seed"
  await_start "$run"
  sleep 50
  echo 1 >&3
  sleep 30
  echo 0 >&3
  finish "$robots"
  wait "$joined" || true
  joined=
  remove_hosts
}

for case in ${*:-agents narrow launcher server planner gateway descriptors host}; do
  for seed in $seeds; do
    run=$out/$case$seed
    seq "$seed" 100000 >"$out/random"
    case $case in
      agents) # ten of them, 6 s each, one every 2 s
        fly swarmprm_standin.yaml
        sleep 30
        for agent in $(some 10 robot_agent); do
          freeze 6 "$agent" &
          sleep 2
        done
        finish "$robots"
        ;;
      narrow) # ten killed while the swarm passes the doorway
        fly doorway.yaml
        sleep 25
        for agent in $(some 10 robot_agent); do
          kill -9 "$agent"
          sleep 1
        done
        finish $((robots - 10))
        ;;
      launcher)
        fly swarmprm_standin.yaml
        sleep 50
        freeze 15 "$launcher"
        finish "$robots"
        ;;
      server) # the topics channel finds its peers by a discovery server in the launcher
        fly swarmprm_standin.yaml --channel topics --processes 32
        sleep 50
        freeze 15 "$launcher"
        finish "$robots"
        ;;
      planner) # its relays too: frozen, then killed
        fly swarmprm_standin.yaml
        sleep 40
        freeze 6 "$(children planner_service)"
        sleep 10
        kill -9 "$(children planner_service)"
        finish "$robots"
        ;;
      gateway) # frozen, then killed
        fly swarmprm_standin.yaml --channel groups --by-gateway 5
        sleep 40
        freeze 15 "$(children swarm_launcher)"
        sleep 5
        kill -9 "$(children swarm_launcher)"
        finish "$robots"
        ;;
      descriptors) # ten agents cannot open another file or socket for 10 s
        fly swarmprm_standin.yaml
        sleep 40
        agents=$(some 10 robot_agent)
        for agent in $agents; do prlimit --pid "$agent" --nofile=3:; done
        sleep 10
        for agent in $agents; do prlimit --pid "$agent" --nofile=1024:; done
        finish "$robots"
        ;;
      host) cut_host ;;
      *)
        echo "unknown case $case" >&2
        exit 3
        ;;
    esac
  done
done
exit "$failed"
