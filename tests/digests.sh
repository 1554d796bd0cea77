#!/bin/sh
# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
# Flies every mission in lock-step with three seeds and compares with tests/data/digests.txt.
#   tests/digests.sh [--update] [BUILD_DIR]     (default: build/release)
# With --update the file is written anew; give the reason of every changed line in the commit.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
update=false
if [ "${1:-}" = --update ]; then
  update=true
  shift
fi
build=${1:-$root/build/release}
export SWARM_DIGEST_SEEDS=3
if [ "$update" = false ]; then
  exec "$build/bin/digests_test"
fi
file=$root/tests/data/digests.txt
made=$(mktemp)
trap 'rm -f "$made"' EXIT
"$build/bin/digests_test" | sed -n 's/^digest: //p' > "$made" || true
[ -s "$made" ] || { echo "digests.sh: no digests: is this processor x86_64 with fma?" >&2; exit 1; }
{
  echo "# What simulate makes of each mission: mission, network, seed, hash of each kind of output."
  echo "# Made by tests/digests.sh --update on x86_64 with fma."
  cat "$made"
} > "$file"
