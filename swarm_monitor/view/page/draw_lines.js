// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Straight lines of a width in pixels, with soft edges, possibly dashed.
import { Program, Quads } from './draw_gl.js';

const VERTEX = `
layout(location = 0) in vec2 aFrom;
layout(location = 1) in vec2 aTo;
layout(location = 2) in float aWidth;  // CSS px
layout(location = 3) in float aDash;   // CSS px, 0: none
layout(location = 4) in vec4 aColour;
out float vAcross;
out float vAlong;
flat out float vHalf;
flat out float vDash;
flat out vec4 vColour;
void main() {
  vec2 path = (aTo - aFrom) * uScale;
  float far = length(path);
  vec2 along = far > 0.0 ? path / far : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  vec2 c = corner();
  vHalf = max(0.5 * aWidth * uPx, 0.5);
  vAcross = c.y * (vHalf + 1.0);
  float cap = min(vHalf, uPx);  // closes the corners of outlines, and no more
  vAlong = c.x < 0.0 ? -cap : far + cap;
  vDash = aDash * uPx;
  vColour = aColour;
  gl_Position = toClip(c.x < 0.0 ? aFrom : aTo, across * vAcross + along * (c.x * cap));
}`;

const FRAGMENT = `
in float vAcross;
in float vAlong;
flat in float vHalf;
flat in float vDash;
flat in vec4 vColour;
void main() {
  float alpha = clamp(vHalf + 0.5 - abs(vAcross), 0.0, 1.0) * vColour.a;
  if (vDash > 0.0 && fract(vAlong / (2.0 * vDash)) > 0.5) discard;
  oColour = vec4(vColour.rgb * alpha, alpha);
}`;

export function lineProgram(gl) {
  return new Program(gl, VERTEX, FRAGMENT);
}

export class Lines extends Quads {
  constructor(gl, program) {
    super(gl, program, 7, [
      [0, 2, gl.FLOAT, 0], [1, 2, gl.FLOAT, 8], [2, 1, gl.FLOAT, 16],
      [3, 1, gl.FLOAT, 20], [4, 4, gl.UNSIGNED_BYTE, 24],
    ]);
  }

  add(a, b, width_px, rgb, alpha, dash_px = 0) {
    this.records.push([a[0], a[1], b[0], b[1], width_px, dash_px], [rgb, alpha]);
  }

  addLoop(points, width_px, rgb, alpha) {
    points.forEach((p, i) => this.add(p, points[(i + 1) % points.length], width_px, rgb, alpha));
  }
}
