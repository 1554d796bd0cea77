#!/bin/sh
# How discovery, latency and CPU grow with the number of one-robot processes: the rows of docs/BENCHMARKS.md, by soak.
# Needs jq. About a minute a row.   tests/bench/scale.sh CHANNEL N …      CHANNEL: groups or topics
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
bin=${SWARM_BIN:-$root/build/release/bin}
channel=$1
shift
out=$(mktemp -d)
echo "runs in $out" >&2
echo '| channel, processes | discovery s | written → received ms p50 / p99 / p99.9 | → used ms p50 / p99 | sent, lost | late ticks % | CPU s | memory MB, all | outcome |'
echo '|---|---|---|---|---|---|---|---|---|'
for n in "$@"; do
  "$bin/swarm_launcher" soak --processes "$n" --duration-s 20 --channel "$channel" --out "$out/$channel-$n" --json \
    >"$out/$channel-$n.json" 2>"$out/$channel-$n.log" || true
  jq -r --arg name "$channel $n" 'def r: if . == null then "–" else (. * 100 | round / 100 | tostring) end;
    "| \($name) | \(.discovery_s | r) | \(.latency_ms.p50 | r) / \(.latency_ms.p99 | r) / \(.latency_ms.p999 | r) | \(.use_latency_ms.p50 | r) / \(.use_latency_ms.p99 | r) | \(.sent), \(.lost) | \(.deadline_miss_ratio * 100 | r) | \(.cpu_s | r) | \(.rss_mb.max | r) | \(.outcome) |"' \
    "$out/$channel-$n.json" || tail -n 2 "$out/$channel-$n.log"
done
