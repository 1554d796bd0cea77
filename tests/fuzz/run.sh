#!/bin/sh
# Fuzzes each decoder with libFuzzer under the address and undefined-behaviour sanitizers:
#   tests/fuzz/run.sh [RUNS] [DECODER…]      (default: 1000000 runs of every decoder)
# Needs clang. Inputs that break something are left in build/fuzz/findings/.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
runs=${1:-1000000}
[ $# -eq 0 ] || shift
cd "$root"
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --target fuzz fuzz_seeds
corpus=build/fuzz/corpus
findings=build/fuzz/findings
mkdir -p "$findings"
all=$(build/fuzz/bin/fuzz_seeds "$corpus")
export ASAN_OPTIONS=detect_leaks=0
failed=0
for decoder in ${*:-$all}; do
  echo "== $decoder"
  mkdir -p "build/fuzz/found/$decoder"
  SWARM_FUZZ=$decoder build/fuzz/bin/fuzz -runs="$runs" -seed=1 -max_len=8192 -timeout=30 -rss_limit_mb=2048 \
    -print_final_stats=1 -verbosity=0 -close_fd_mask=0 -artifact_prefix="$findings/$decoder-" \
    "build/fuzz/found/$decoder" "$corpus/$decoder" 2>"build/fuzz/$decoder.log" || failed=1
  grep -E "stat::number_of_executed_units|ERROR|SUMMARY|runtime error" "build/fuzz/$decoder.log" || true
done
exit $failed
