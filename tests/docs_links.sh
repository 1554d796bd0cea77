#!/bin/sh
# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
# Checks that every relative link in a Markdown file names a file or folder that exists.
set -eu
cd "$(dirname "$0")/.."
find . -name '*.md' -not -path './build/*' -not -path '*/node_modules/*' | while read -r page; do
  grep -o ']([^)]*)' "$page" | sed 's/^](//; s/)$//; s/#.*//' | grep -v -e '^$' -e '^[a-z]*:' | while read -r link; do
    [ -e "$(dirname "$page")/$link" ] || echo "$page: no $link"
  done
done | { ! grep .; }
