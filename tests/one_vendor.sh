#!/bin/sh
# Builds the programs with one vendor's DDS alone, looks that they need no library of the other, and flies a mission.
#   tests/one_vendor.sh fastdds|cyclonedds      Needs jq. A build of its own: some minutes.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
case $1 in
  fastdds) other=CYCLONEDDS library=libddsc ;;
  cyclonedds) other=FASTDDS library=libfastrtps ;;
  *) echo "usage: $0 fastdds|cyclonedds" >&2; exit 3 ;;
esac
build=$root/build/only-$1
cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DSWARM_BUILD_TESTS=OFF "-DSWARM_WITH_$other=OFF" \
  ${CMAKE_CXX_COMPILER_LAUNCHER:+"-DCMAKE_CXX_COMPILER_LAUNCHER=$CMAKE_CXX_COMPILER_LAUNCHER"}
cmake --build "$build"
for program in swarm_launcher planner_service robot_agent swarm_monitor; do
  ! ldd "$build/bin/$program" | grep "$library" || { echo "$program needs $library" >&2; exit 1; }
done
run=$(mktemp -d)/run
"$build/bin/swarm_launcher" run "$root/deploy/missions/small.yaml" --channel groups --out "$run" --json |
  jq -e '.arrived == .robots and .collisions_robot == 0 and .collisions_obstacle == 0' >/dev/null
echo "$1 alone: $(jq -c '{robots, arrived, collisions_robot, collisions_obstacle}' "$run/summary.json")"
