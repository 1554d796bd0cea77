#!/bin/sh
# Installs what is missing, builds and runs all tests; ends with ctest's closing line, or with the end of what each failed
# test printed.
#   tests/run.sh [release|asan|tsan]      (default: release)
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
preset=${1:-release}
usage="usage: tests/run.sh [release|asan|tsan]    (default: release)
Installs the Debian packages that are missing, builds everything and runs all tests."
case $preset in
  -h | --help) echo "$usage"; exit 0 ;;
  release | asan | tsan) ;;
  *) echo "tests/run.sh: unknown preset $preset
$usage" >&2; exit 3 ;;
esac
cd "$root"
deploy/install_packages.sh deploy/packages.txt deploy/test_packages.txt
cmake --preset "$preset" -DSWARM_BUILD_TESTS=ON
cmake --build --preset "$preset"
ctest --preset "$preset" && exit 0
code=$?
tested=build/$preset/Testing/Temporary
[ ! -f "$tested/LastTestsFailed.log" ] || cut -d: -f2- "$tested/LastTestsFailed.log" | while IFS= read -r name; do
  echo "==== $name printed at its end:"
  awk -v name="$name" '/ Testing: / { on = substr($0, index($0, " Testing: ") + 10) == name } on' "$tested/LastTest.log" | tail -n 40
done
exit $code
