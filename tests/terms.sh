#!/bin/sh
# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
# Fails where code, comments, messages, test names or documents use words that are not the field's.
#   terms.sh [--counts] [ALLOWED]     run in the repository; ALLOWED: a regex a line, tab, reason (default: beside this file)
set -eu
git ls-files >/dev/null 2>&1 || { echo "terms.sh: not a git checkout: nothing is checked" >&2; exit 77; }
here=$(cd "$(dirname "$0")" && pwd)
counts=
if [ "${1:-}" = --counts ]; then counts=1; shift; fi
COUNTS=$counts ALLOWED=${1:-$here/terms_allowed.txt} exec python3 - <<'PY'
import collections, os, re, subprocess, sys

TERMS = '''say says said saying tell tells told telling hear hears heard hearing deaf believe believes believed belief beliefs
word words dear dearest dust patience scribe sieve felt shy forgive sift sifted crew air star whoever nobody blackbox blackboxes
way ways'''.split()
PHRASES = ['black box', 'black boxes', 'so many', 'so long', 'so manieth', 'coin toss', 'sensing range', 'hearing radius']
PARTS = re.compile(r'[A-Z]+(?![a-z])|[A-Z]?[a-z]+')
TOKEN = re.compile(r'[A-Za-z][A-Za-z0-9_]*')
terms = set(TERMS)
phrases = re.compile(r'\b(' + '|'.join(PHRASES) + r')\b', re.I)
allowed = []
for line in open(os.environ['ALLOWED'], encoding='utf-8'):
    if line.strip() and not line.startswith('#'):
        allowed.append(re.compile(line.rstrip('\n').split('\t')[0]))
files = subprocess.check_output(['git', 'ls-files'], text=True).split('\n')
wanted = re.compile(r'(\.(cpp|hpp|h|js|mjs|html|css|py|sh|cmake|idl|md)|CMakeLists\.txt)$')
found, folders = 0, collections.Counter()
for path in files:
    if not wanted.search(path) or path.startswith("tests/terms") or path == 'docs/soak-300.html':
        continue
    for number, line in enumerate(open(path, encoding='utf-8', errors='replace'), 1):
        rest = line
        for pattern in allowed:
            # A pattern with `path:` in front allows whole lines of files.
            if pattern.pattern.startswith('path:'):
                if re.match(pattern.pattern[5:], f'{path}:{line.strip()}'):
                    rest = ''
            else:
                rest = pattern.sub('', rest)
        hits = {m.group(1).lower() for m in phrases.finditer(rest)}
        for token in TOKEN.findall(rest):
            hits.update(p.lower() for p in PARTS.findall(token) if p.lower() in terms)
        if hits:
            found += 1
            folders[(path.split('/')[0] if '/' in path else '.', ', '.join(sorted(hits)))] += 1
            if not os.environ['COUNTS']:
                print(f'{path}:{number}: {", ".join(sorted(hits))}: {line.strip()}')
if os.environ['COUNTS']:
    by_folder, by_word = collections.Counter(), collections.Counter()
    for (folder, hits), n in folders.items():
        by_folder[folder] += n
        for hit in hits.split(', '):
            by_word[hit] += n
    print('\n'.join(f'{n:5d} {folder}' for folder, n in by_folder.most_common()))
    print('\n'.join(f'{n:5d} "{word}"' for word, n in by_word.most_common()))
print(f'terms.sh: {found} lines', file=sys.stderr)
sys.exit(1 if found else 0)
PY
