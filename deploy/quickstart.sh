#!/bin/sh
# From a bare Debian 12 to a hundred flying robots: installs what is missing, builds, flies the demo mission
# with one process per robot, and prints where the report is.   deploy/quickstart.sh [--robots N]
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
robots=100
while [ $# -gt 0 ]; do
  case "$1" in
    --robots) robots=${2:?--robots needs a number}; shift 2 ;;
    -h | --help) sed -n '2,3s/^# //p' "$0"; exit 0 ;;
    *) echo "quickstart.sh: unknown option $1; see --help" >&2; exit 3 ;;
  esac
done

"$root/deploy/install_packages.sh"
cd "$root"
cmake --preset release
cmake --build --preset release --target planner_service robot_agent swarm_launcher swarm_monitor
exec build/release/bin/swarm_launcher run deploy/missions/swarmprm_standin.yaml --robots "$robots"
