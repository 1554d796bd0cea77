#!/bin/sh
# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
# Installs the build into a prefix, moves the prefix, builds the examples against it as an external project would
# and runs their missions. Usage: run.sh BUILD_DIR
set -eu
build=$1
here=$(cd "$(dirname "$0")" && pwd)
examples=$here/../../examples
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $*" >&2; exit 1; }

cmake --install "$build" --prefix "$work/first" >"$work/install.log"
mv "$work/first" "$work/prefix"
prefix=$work/prefix
launcher=$prefix/bin/swarm_launcher

# Eigen takes most of the time of the compiler, so it is precompiled: a header that uses it must name it itself.
echo "public headers compile alone, and include nothing of a vendor's, a parser's or ours that is private"
eigen=$(pkg-config --cflags eigen3)
echo '#include <Eigen/Core>' >"$work/eigen.hpp"
g++ -std=c++20 $eigen -x c++-header "$work/eigen.hpp" -o "$work/eigen.hpp.gch"
cd "$prefix/include"
find swarmflow -name '*.hpp' >"$work/headers.txt"
while read -r header; do
  if grep -nE '#include [<"](fastdds|fastrtps|fastcdr|dds|ddsc|yaml-cpp|nlohmann|png|coin|CLI|fmt|swarm_|robot_agent|planner_service)' "$header"; then
    fail "$header includes what is not public"
  fi
  if grep -q 'Eigen::' "$header" && ! grep -q '#include <Eigen/' "$header"; then
    fail "$header uses Eigen and does not include it"
  fi
done <"$work/headers.txt"
xargs -P 2 -I{} sh -c "echo '#include <{}>' | g++ -std=c++20 -fsyntax-only -Wno-ignored-attributes -include $work/eigen.hpp -I. $eigen -x c++ - ||
  { echo '{} does not compile alone' >&2; exit 255; }" <"$work/headers.txt"

# Libraries with a sanitizer need it in the programs that they are linked to.
sanitizers=$(sed -n 's/^SWARM_SANITIZE:STRING=//p' "$build/CMakeCache.txt")
flags=${sanitizers:+-fsanitize=$sanitizers}

echo "examples build against the prefix"
for example in "$examples"/own_*; do
  name=$(basename "$example")
  cmake -S "$example" -B "$work/$name" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_CXX_FLAGS="$flags" >"$work/$name.log" ||
    { cat "$work/$name.log"; fail "$name does not configure"; }
  cmake --build "$work/$name" >"$work/$name.log" || { cat "$work/$name.log"; fail "$name does not build"; }
done

# fly NAME MISSION OPTIONS...: a run; its summary is NAME.json. Its exit code is not judged here.
fly() {
  name=$1 mission=$2
  shift 2
  "$launcher" run "$mission" --out "$work/run_$name" --json "$@" >"$work/$name.json" 2>"$work/$name.err" || true
}
# value NAME KEY
value() { tr -d '\n' <"$work/$1.json" | sed -n "s/.*\"$2\": *\"\{0,1\}\([^,\"}]*\).*/\1/p"; }
expect() {
  actual=$(value "$1" "$2")
  [ "$actual" = "$3" ] || { cat "$work/$1.err" "$work/$1.json"; fail "$1: $2 is '$actual', not '$3'"; }
}
expect_good() {
  expect "$1" outcome ok
  expect "$1" arrived "$2"
  expect "$1" collisions_robot 0
  expect "$1" collisions_obstacle 0
}

echo "own_controller flies 20 processes; own_monitor looks on, then reads the recording"
"$launcher" run "$examples/own_controller/mission.yaml" --agent-program "$work/own_controller/own_controller" \
  --out "$work/run_controller" --json >"$work/controller.json" 2>"$work/controller.err" &
run=$!
tries=0
until [ -e "$work/run_controller/control.sock" ] || [ $tries -gt 300 ]; do sleep 0.1; tries=$((tries + 1)); done
"$work/own_monitor/own_monitor" "$work/run_controller" >"$work/monitor.txt" || { cat "$work/monitor.txt"; fail "own_monitor"; }
grep -q "m off the plan" "$work/monitor.txt" || fail "own_monitor saw no plan"
wait $run || true
expect_good controller 20
"$work/own_monitor/own_monitor" "$work/run_controller" --recorded | grep -q "20 robots arrived" || fail "own_monitor --recorded"

echo "its keys are checked with line and column"
sed 's/carrot_m: 1.5/carrot_m: -1/; s/gain_hz: 1.0/gian_hz: 1/' "$examples/own_controller/mission.yaml" >"$work/wrong.yaml"
"$launcher" run "$work/wrong.yaml" --agent-program "$work/own_controller/own_controller" 2>"$work/wrong.err" && fail "wrong keys were accepted"
grep -q 'wrong.yaml:[0-9]*:[0-9]*: control.carrot_m is -1; must be > 0' "$work/wrong.err" || { cat "$work/wrong.err"; fail "no place of a wrong value"; }
grep -q 'unknown key control.gian_hz; did you mean control.gain_hz' "$work/wrong.err" || { cat "$work/wrong.err"; fail "no hint for a wrong key"; }

echo "own_driver and own_planner fly"
fly driver "$examples/own_driver/mission.yaml" --agent-program "$work/own_driver/own_driver"
expect_good driver 12
fly planner "$examples/own_planner/mission.yaml" --planner-program "$work/own_planner/own_planner"
expect_good planner 12

echo "all good"
