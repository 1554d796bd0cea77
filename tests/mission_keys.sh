#!/bin/sh
# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
# Compares docs/mission-keys.md with what the programs make of their tables.
#   tests/mission_keys.sh [--update] [LAUNCHER]     (default: build/release/bin/swarm_launcher)
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
update=false
if [ "${1:-}" = --update ]; then
  update=true
  shift
fi
launcher=${1:-$root/build/release/bin/swarm_launcher}
file=$root/docs/mission-keys.md
if [ "$update" = true ]; then
  "$launcher" keys > "$file"
  exit
fi
if ! "$launcher" keys | diff "$file" -; then
  echo "mission_keys.sh: docs/mission-keys.md is not what the tables make; renew it by" >&2
  echo "  tests/mission_keys.sh --update" >&2
  exit 1
fi
