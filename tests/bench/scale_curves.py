#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
"""Draws the rows that scale.sh prints, one file a channel:  scale_curves.py groups.md topics.md > docs/scale.svg"""
import re
import sys

PANELS = [("discovery, s", 2, 0), ("written to received, p99, ms", 3, 1), ("CPU s, 20 s of motion and the start", 7, 0), ("late ticks, %", 6, 0)]
COLOURS = {"groups": "#1f6fb4", "topics": "#d2601a"}
WIDTH, HEIGHT, LEFT, BOTTOM, TOP = 380, 230, 48, 34, 26


def rows(path):
    for line in open(path):
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        named = re.fullmatch(r"(groups|topics) (\d+)", cells[0])
        if named:
            yield named[1], int(named[2]), [""] + cells


def value(cells, column, part):
    text = cells[column].split("/")[part].strip() if "/" in cells[column] else cells[column]
    return None if text in ("–", "null", "") else float(text)


data = [row for path in sys.argv[1:] for row in rows(path)]
n_max = max(n for _, n, _ in data)
print(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {2 * WIDTH} {2 * HEIGHT + 8}" '
      'font-family="sans-serif" font-size="11" fill="none">')
print(f'<rect width="{2 * WIDTH}" height="{2 * HEIGHT + 8}" fill="white"/>')
for index, (title, column, part) in enumerate(PANELS):
    points = {}
    for channel, n, cells in data:
        y = value(cells, column, part)
        if y is not None:
            points.setdefault(channel, []).append((n, y))
    top = max(y for series in points.values() for _, y in series) or 1.0
    x0, y0 = (index % 2) * WIDTH + LEFT, (index // 2) * HEIGHT + HEIGHT - BOTTOM
    plot_width, plot_height = WIDTH - LEFT - 16, HEIGHT - BOTTOM - TOP
    print(f'<text x="{x0}" y="{y0 - plot_height - 10}" fill="#222" font-weight="bold">{title}</text>')
    for share in (0, 0.5, 1):
        y = y0 - share * plot_height
        print(f'<path d="M{x0} {y}h{plot_width}" stroke="#ddd"/>'
              f'<text x="{x0 - 6}" y="{y + 4}" fill="#555" text-anchor="end">{share * top:.3g}</text>')
    for n in range(0, n_max + 1, 200):
        print(f'<text x="{x0 + n / n_max * plot_width}" y="{y0 + 16}" fill="#555" text-anchor="middle">{n}</text>')
    for channel, series in points.items():
        line = " ".join(f"{x0 + n / n_max * plot_width:.1f},{y0 - y / top * plot_height:.1f}" for n, y in sorted(series))
        print(f'<polyline points="{line}" stroke="{COLOURS[channel]}" stroke-width="2"/>')
        for point in line.split():
            x, y = point.split(",")
            print(f'<circle cx="{x}" cy="{y}" r="3" fill="{COLOURS[channel]}"/>')
for i, (channel, colour) in enumerate(COLOURS.items()):
    print(f'<text x="{WIDTH - 90 + 60 * i}" y="16" fill="{colour}" font-weight="bold">{channel}</text>')
print(f'<text x="{WIDTH}" y="{2 * HEIGHT + 2}" fill="#555" text-anchor="middle">processes</text>\n</svg>')
