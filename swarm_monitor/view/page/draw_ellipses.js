// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Ellipses: filled, outlined or both, the outline in pixels and possibly dashed.
import { Program, Quads } from './draw_gl.js';

const VERTEX = `
layout(location = 0) in vec2 aCentre;
layout(location = 1) in vec2 aAxis;    // unit vector of the longer one
layout(location = 2) in vec2 aHalf;    // semi-axes, m
layout(location = 3) in float aWidth;  // CSS px
layout(location = 4) in float aDash;   // CSS px, 0: none
layout(location = 5) in vec4 aFill;
layout(location = 6) in vec4 aStroke;
out vec2 vAt;
flat out vec2 vHalf;
flat out vec2 vLine;
flat out vec4 vFill;
flat out vec4 vStroke;
void main() {
  vHalf = max(aHalf * uScale, vec2(0.5));
  vLine = vec2(aWidth, aDash) * uPx;
  vAt = corner() * (vHalf + 0.5 * vLine.x + 1.0);
  vFill = aFill;
  vStroke = aStroke;
  gl_Position = toClip(aCentre, aAxis * vAt.x + vec2(-aAxis.y, aAxis.x) * vAt.y);
}`;

// The distance is a first-order one: exact on the rim, which is where it matters.
const FRAGMENT = `
in vec2 vAt;
flat in vec2 vHalf;
flat in vec2 vLine;
flat in vec4 vFill;
flat in vec4 vStroke;
void main() {
  vec2 unit = vAt / vHalf;
  float k = length(unit);
  float d = k < 1e-4 ? -min(vHalf.x, vHalf.y) : k * (k - 1.0) / length(unit / vHalf);
  float fill = clamp(0.5 - d, 0.0, 1.0) * vFill.a;
  float line = clamp(0.5 * vLine.x + 0.5 - abs(d), 0.0, 1.0) * vStroke.a;
  if (vLine.y > 0.0) {
    float turns = atan(unit.y, unit.x) / 6.2831853;
    float dashes = max(8.0, round(6.2831853 * sqrt(0.5 * dot(vHalf, vHalf)) / (2.0 * vLine.y)));
    if (fract(turns * dashes) > 0.55) line = 0.0;
  }
  float alpha = line + fill * (1.0 - line);
  if (alpha == 0.0) discard;
  oColour = vec4(vStroke.rgb * line + vFill.rgb * fill * (1.0 - line), alpha);
}`;

export function ellipseProgram(gl) {
  return new Program(gl, VERTEX, FRAGMENT);
}

export class Ellipses extends Quads {
  constructor(gl, program) {
    super(gl, program, 10, [
      [0, 2, gl.FLOAT, 0], [1, 2, gl.FLOAT, 8], [2, 2, gl.FLOAT, 16], [3, 1, gl.FLOAT, 24],
      [4, 1, gl.FLOAT, 28], [5, 4, gl.UNSIGNED_BYTE, 32], [6, 4, gl.UNSIGNED_BYTE, 36],
    ]);
  }

  /** `look`: {fill, fillAlpha, stroke, strokeAlpha, width, dash}. */
  addCircle(x, y, radius_m, look) {
    this.#push(x, y, 1, 0, radius_m, radius_m, look);
  }

  /** The ellipse `sigmas` standard deviations out, of covariance xx, xy, yy. */
  addGaussian(x, y, xx, xy, yy, sigmas, look) {
    const middle = 0.5 * (xx + yy);
    const spread = Math.hypot(0.5 * (xx - yy), xy);
    const angle = 0.5 * Math.atan2(2 * xy, xx - yy);
    this.#push(x, y, Math.cos(angle), Math.sin(angle), sigmas * Math.sqrt(Math.max(middle + spread, 0)),
      sigmas * Math.sqrt(Math.max(middle - spread, 0)), look);
  }

  #push(x, y, ux, uy, a, b, look) {
    this.records.push([x, y, ux, uy, a, b, look.width ?? 0, look.dash ?? 0],
      [look.fill ?? look.stroke, look.fillAlpha ?? 0], [look.stroke ?? look.fill, look.strokeAlpha ?? 0]);
  }
}
