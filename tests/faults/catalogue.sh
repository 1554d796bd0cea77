#!/bin/sh
# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
# Checks that the table of README.md is true: every test that a row names, as [Suite.Name](file), is defined in that
# file and runs in a build; every row of a fault names a test or states that there is none; every file here is named.
set -eu
cd "$(dirname "$0")"
{
  grep -o '\[[A-Za-z0-9]*\.[A-Za-z0-9]*\]([^)]*_test\.cpp)' README.md | sort -u | while IFS= read -r link; do
    test=${link#?} file=${link##*\(}
    test=${test%%\]*} file=${file%\)}
    suite=${test%.*} name=${test#*.}
    if ! [ -e "$file" ]; then
      echo "$link: no such file"
    elif ! tr -d '\n' <"$file" | grep -qE "TEST(_F|_P)?\($suite, *$name\)"; then
      echo "$link: the file has no such test"
    elif ! grep -q "$(basename "$file")" "$(dirname "$file")"/CMakeLists.txt "$(dirname "$file")"/../CMakeLists.txt \
      "$(dirname "$file")"/../../CMakeLists.txt "$(dirname "$file")"/../../../CMakeLists.txt 2>/dev/null; then
      echo "$link: no target builds the file"
    fi
  done
  grep -E '^\| [0-9]+ ' README.md | grep -vE '_test\.cpp\)|not tried' | sed 's/$/: names no test/'
  for file in *_test.cpp; do
    grep -qF "($file)" README.md || echo "$file: not in the table"
  done
} | { ! grep .; }
