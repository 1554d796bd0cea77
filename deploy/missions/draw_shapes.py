#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
"""Draws diffusion_q.png and diffusion_jie.png beside itself: strokes of one width on [-6, 6] x [-6, 6] m, a pixel of
0.05 m each, dark where its centre lies on a stroke. Prints the areas, which limit the robots."""
import math
import pathlib
import struct
import zlib

SIDE, PIXEL_M = 240, 0.05


def distance_to_stroke(p, points):
    best = math.inf
    for (ax, ay), (bx, by) in zip(points, points[1:]):
        dx, dy = bx - ax, by - ay
        s = max(0.0, min(1.0, ((p[0] - ax) * dx + (p[1] - ay) * dy) / (dx * dx + dy * dy)))
        best = min(best, math.hypot(p[0] - ax - s * dx, p[1] - ay - s * dy))
    return best


def draw(name, strokes, width_m):
    rows, dark = b"", 0
    for row in range(SIDE):
        y = 6.0 - (row + 0.5) * PIXEL_M
        levels = bytearray()
        for column in range(SIDE):
            p = ((column + 0.5) * PIXEL_M - 6.0, y)
            on = any(distance_to_stroke(p, s) <= width_m / 2 for s in strokes)
            dark += on
            levels.append(0 if on else 255)
        rows += b"\0" + bytes(levels)
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    png = (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", SIDE, SIDE, 8, 0, 0, 0, 0))
           + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))
    (pathlib.Path(__file__).parent / f"{name}.png").write_bytes(png)
    print(f"{name}: {dark * PIXEL_M**2:.1f} m2")


RING = [(3.6 * math.cos(a * math.pi / 60), 0.35 + 4.1 * math.sin(a * math.pi / 60)) for a in range(121)]
TAIL = [(0.9, -1.9), (2.1, -3.1), (4.0, -5.0)]
draw("diffusion_q", [RING, TAIL], 0.5)

# The character jie: a field above, which is one component, and below it a roof on two legs, the other.
FIELD = ([[(x, 0.9), (x, 5.3)] for x in (-3.0, 0.0, 3.0)] + [[(-3.0, y), (3.0, y)] for y in (0.9, 3.1, 5.3)])
ROOF = [[(-4.9, -3.7), (0.0, -0.5), (4.9, -3.7)]]
LEGS = [[(-1.5, -1.6), (-1.7, -3.6), (-2.7, -5.3)], [(1.6, -1.6), (1.6, -5.3)]]
draw("diffusion_jie", FIELD + ROOF + LEGS, 0.45)
