# Sourced by two_hosts.sh and silence.sh, which set $root, $bin and $robots: two hosts, each a network namespace of this machine,
# and a mission flown by both. Needs root, iproute2 and python3.
# shellcheck shell=sh disable=SC2154

host_a=swarmflow-a-$$
host_b=swarmflow-b-$$
launcher=
joined=
exec 3>/dev/null

# make_hosts FOLDER LOSS DELAY_MS: loss and delay of the cable between them; later losses are written to descriptor 3
make_hosts() {
  ip netns add "$host_a"
  ip netns add "$host_b"
  mkfifo "$1/loss" "$1/ready"
  "$root/tests/bench/lossy_cable.py" "$host_a" cable-a "$host_b" cable-b "$2" "$3" <"$1/loss" >"$1/ready" &
  exec 3>"$1/loss" # the cable ends when this is closed
  read -r _ <"$1/ready"
  for end in "$host_a cable-a 10.77.0.1" "$host_b cable-b 10.77.0.2"; do
    # shellcheck disable=SC2086
    set -- $end
    ip -n "$1" link set lo up
    ip -n "$1" addr add "$3/24" dev "$2"
    ip -n "$1" link set "$2" up
  done
}

remove_hosts() {
  exec 3>/dev/null
  ip netns del "$host_a" 2>/dev/null || true
  ip netns del "$host_b" 2>/dev/null || true
}

# fly_on_both MISSION RUN [OPTIONS …]: half of the robots on each host, in the background, as $launcher and $joined
fly_on_both() {
  mission=$1
  run=$2
  shift 2
  ip netns exec "$host_a" "$bin/swarm_launcher" run "$mission" --robots "$robots" --out "$run" --json --interface 10.77.0.1 \
    --remote $((robots / 2)) --join-port 7000 "$@" >/dev/null 2>"$run.log" &
  launcher=$!
  until grep -qs 'swarm_launcher join' "$run.log"; do
    kill -0 "$launcher"
    sleep 0.2
  done
  ip netns exec "$host_b" "$bin/swarm_launcher" join 10.77.0.1:7000 --robots $((robots / 2)) --out "$run-b" 2>"$run-b.log" &
  joined=$!
}

# await_start RUN: until its mission has started
await_start() {
  until grep -qs '"text":"start"' "$1/events.jsonl"; do
    kill -0 "$launcher"
    sleep 0.2
  done
}
