// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The world's floor: bounds, a grid in metres, and the cells of the state channel.
import { Program } from './draw_gl.js';

const VERTEX = `
uniform vec4 uBounds;
out vec2 vMetres;
void main() {
  vec2 c = 0.5 * (corner() + 1.0);
  vec2 rim = (c * 2.0 - 1.0) * 2.0 * uPx;
  vMetres = mix(uBounds.xy, uBounds.zw, c) + rim / uScale;
  gl_Position = toClip(mix(uBounds.xy, uBounds.zw, c), rim);
}`;

const FRAGMENT = `
uniform vec4 uBounds;
uniform float uStep;   // m
uniform float uCell;   // m, 0: hidden
uniform vec2 uCellAt;  // m, the corner of a cell
uniform vec3 uGround;
uniform vec3 uGrid;
uniform vec3 uCellColour;
uniform vec3 uRim;
uniform vec3 uOutside;
in vec2 vMetres;
// How much of this pixel a line of one CSS pixel every \`step\` covers.
float lines(float step, vec2 from) {
  vec2 off = abs(fract((vMetres - from) / step + 0.5) - 0.5) * step * uScale;
  return clamp(0.5 * uPx + 0.5 - min(off.x, off.y), 0.0, 1.0);
}
void main() {
  vec2 inside = min(vMetres - uBounds.xy, uBounds.zw - vMetres) * uScale;
  float d = min(inside.x, inside.y);
  vec3 colour = mix(uGround, uGrid, lines(uStep, vec2(0.0)));
  if (uCell > 0.0) {
    // Cells of a few pixels would be a grey sheet: they fade away.
    colour = mix(colour, uCellColour, lines(uCell, uCellAt) * smoothstep(3.0, 12.0, uCell * uScale / uPx) * 0.6);
  }
  colour = mix(uOutside, colour, clamp(d + 0.5, 0.0, 1.0));
  colour = mix(colour, uRim, clamp(0.5 * uPx + 0.5 - abs(d), 0.0, 1.0));
  oColour = vec4(colour, 1.0);
}`;

export class Ground {
  constructor(gl) {
    this.gl = gl;
    this.program = new Program(gl, VERTEX, FRAGMENT);
    this.vao = gl.createVertexArray();
  }

  /** `cell_m` 0: no cells; they begin at the mission's (0, 0), the map at `origin`. */
  draw(view, theme, { bounds, origin }, step_m, cell_m) {
    const { gl } = this;
    const at = this.program.use(view);
    gl.uniform4f(at.uBounds, bounds[0][0], bounds[0][1], bounds[1][0], bounds[1][1]);
    gl.uniform1f(at.uStep, step_m);
    gl.uniform1f(at.uCell, cell_m);
    gl.uniform2f(at.uCellAt, ...origin.map((o) => (cell_m > 0 ? -(o % cell_m) : 0)));
    gl.uniform3fv(at.uGround, theme.ground);
    gl.uniform3fv(at.uGrid, theme.grid);
    gl.uniform3fv(at.uCellColour, theme.cell);
    gl.uniform3fv(at.uRim, theme.rim);
    gl.uniform3fv(at.uOutside, theme.outside);
    gl.bindVertexArray(this.vao);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }
}
