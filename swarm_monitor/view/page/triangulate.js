// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Ear clipping: a simple polygon, concave or not, of either orientation, as triangles.

function twiceArea(a, b, c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/** Indices into `points`, three a triangle. */
export function triangulate(points) {
  const left = points.map((_, i) => i);
  let area = 0;
  points.forEach((p, i) => {
    const q = points[(i + 1) % points.length];
    area += p[0] * q[1] - p[1] * q[0];
  });
  if (area < 0) left.reverse();

  const out = [];
  while (left.length > 3) {
    const ear = left.findIndex((_, i) => isEar(points, left, i));
    // No ear: the polygon crosses itself. Cutting anywhere ends the loop and draws most of it.
    const at = Math.max(ear, 0);
    const n = left.length;
    out.push(left[(at + n - 1) % n], left[at], left[(at + 1) % n]);
    left.splice(at, 1);
  }
  if (left.length === 3) out.push(...left);
  return out;
}

function isEar(points, left, i) {
  const n = left.length;
  const [ia, ib, ic] = [left[(i + n - 1) % n], left[i], left[(i + 1) % n]];
  const [a, b, c] = [points[ia], points[ib], points[ic]];
  const area = twiceArea(a, b, c);
  if (area < 0) return false;
  if (area === 0) return true;  // a corner on a straight side goes without a trace
  return !left.some((k) => {
    if (k === ia || k === ib || k === ic) return false;
    const p = points[k];
    const same = (q) => p[0] === q[0] && p[1] === q[1];
    if (same(a) || same(b) || same(c)) return false;
    return twiceArea(a, b, p) >= 0 && twiceArea(b, c, p) >= 0 && twiceArea(c, a, p) >= 0;
  });
}
