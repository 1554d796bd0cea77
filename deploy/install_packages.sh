#!/bin/sh
# Installs what deploy/packages.txt, or the lists given, name and this machine lacks. Does nothing, and needs no rights,
# when nothing is missing.   deploy/install_packages.sh [LIST …]
set -eu
here=$(cd "$(dirname "$0")" && pwd)

missing=""
[ $# -gt 0 ] || set -- "$here/packages.txt"
for list in "$@"; do
  [ -r "$list" ] && continue
  echo "$list: not a list of packages. Usage: deploy/install_packages.sh [LIST …] (default: deploy/packages.txt)" >&2
  exit 2
done
for line in $(cat "$@" | sed 's/#.*//'); do
  package=${line%|*}
  [ "$line" = "$package" ] || ! command -v "${line#*|}" >/dev/null || continue
  dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed ||
    missing="$missing $package"
done
[ -n "$missing" ] || exit 0

echo "Installing Debian packages:$missing" >&2
if [ "$(id -u)" -eq 0 ]; then
  run=""
elif command -v sudo >/dev/null 2>&1; then
  run="sudo"
else
  echo "Run this as root, or install sudo, or install the packages above by hand." >&2
  exit 2
fi
export DEBIAN_FRONTEND=noninteractive
$run apt-get update -qq >&2
# shellcheck disable=SC2086  # one word per package
$run apt-get install -y -qq --no-install-recommends $missing >&2
