// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Robots, drawn from the bytes of a frame: the 16 bytes of a robot are one texel, so no objects are made and
// nothing is copied. Two frames stay on the GPU, which interpolates between them.
import { Program } from './draw_gl.js';
import { HEADER_BYTES, ROBOT_BYTES } from './view_frame.js';

const WIDTH = 1024;

// Also used by the trails, which begin where the robots are drawn. First of all: read().
export const ROBOT = `
uniform usampler2D uBeforeFrame;
uniform usampler2D uNowFrame;
uniform float uMix;
uniform bool uByMode;
uniform vec3 uGoals[9];  // the last: none
uniform vec3 uModes[5];
uvec4 before;  // x, y, heading, and the bytes: mode, goal, flags, neighbours
uvec4 now;
void read(int id) {
  ivec2 at = ivec2(id % ${WIDTH}, id / ${WIDTH});
  before = texelFetch(uBeforeFrame, at, 0);
  now = texelFetch(uNowFrame, at, 0);
}
bool drawn() { return (now.w & 0x50000u) != 0u; }
bool lost() { return (now.w & 0x40000u) != 0u; }
bool arrived() { return (now.w & 0x20000u) != 0u; }
float part() { return (before.w & 0x50000u) != 0u ? uMix : 1.0; }
vec2 position() { return mix(uintBitsToFloat(before.xy), uintBitsToFloat(now.xy), part()); }
float heading() {
  float to = uintBitsToFloat(now.z);
  float turn = mod(to - uintBitsToFloat(before.z) + 3.14159265, 6.2831853) - 3.14159265;
  return to - turn * (1.0 - part());
}
vec3 colour() {
  if (uByMode) return uModes[min(now.w & 255u, 4u)];
  uint goal = (now.w >> 8) & 255u;
  return uGoals[goal == 255u ? 8u : goal % 8u];
}
`;

const VERTEX = `${ROBOT}
uniform float uRadius;  // m
uniform vec3 uLost;
uniform vec3 uGround;
out vec2 vAt;
flat out float vR;
flat out vec2 vHeading;
flat out vec3 vColour;
flat out int vKind;  // 0 with a heading, 1 arrived, 2 lost
void main() {
  read(gl_VertexID / 6);
  if (!drawn()) { gl_Position = kNowhere; return; }
  vR = max(uRadius * uScale, 3.0 * uPx);
  vKind = lost() ? 2 : arrived() ? 1 : 0;
  vColour = vKind == 2 ? uLost : vKind == 1 ? mix(colour(), uGround, 0.3) : colour();
  vHeading = vec2(cos(heading()), sin(heading()));
  int k = gl_VertexID % 6;  // two triangles: corners 0 1 2, 2 1 3
  k = k < 3 ? k : k == 3 ? 2 : k == 4 ? 1 : 3;
  vec2 square = vec2(k & 1, k >> 1) * 2.0 - 1.0;
  vAt = square * (vKind == 0 && vR < 5.0 * uPx ? 1.9 * vR + 0.5 * uPx : vR + 1.5 * uPx);
  gl_Position = toClip(position(), vAt);
}`;

const FRAGMENT = `
uniform vec3 uGround;
in vec2 vAt;
flat in float vR;
flat in vec2 vHeading;
flat in vec3 vColour;
flat in int vKind;
void main() {
  float d = length(vAt) - vR;
  // A hair of ground around each disc keeps neighbours apart.
  float halo = clamp(0.5 + 0.8 * uPx - d, 0.0, 1.0) * 0.85;
  float disc = clamp(0.5 - d, 0.0, 1.0);
  if (vKind == 2) disc *= clamp(0.5 + d + 1.8 * uPx, 0.0, 1.0);
  vec3 rgb = vColour * disc + uGround * halo * (1.0 - disc);
  float alpha = disc + halo * (1.0 - disc);
  if (vKind == 0) {
    float along = dot(vAt, vHeading);
    float across = abs(dot(vAt, vec2(-vHeading.y, vHeading.x)));
    // Small discs carry the heading outside, where it can be seen.
    bool outside = vR < 5.0 * uPx;
    float tip = outside ? 1.9 * vR : 0.92 * vR;
    float half_width = outside ? 0.55 * uPx : max(0.11 * vR, 0.7 * uPx);
    float tick = clamp(half_width + 0.5 - across, 0.0, 1.0) * clamp(tip + 0.5 - along, 0.0, 1.0) *
      clamp(along + 0.5, 0.0, 1.0);
    rgb = mix(rgb, outside ? vColour : uGround, tick);
    alpha = max(alpha, tick);
  }
  if (alpha == 0.0) discard;
  oColour = vec4(rgb, alpha);
}`;

export class Robots {
  constructor(gl) {
    this.gl = gl;
    this.program = new Program(gl, VERTEX, FRAGMENT);
    this.vao = gl.createVertexArray();
    this.textures = [null, null];
    this.now = 0;
    this.count = 0;
  }

  set(viewFrame) {
    const { gl } = this;
    const anew = viewFrame.n !== this.count;
    if (anew) this.#allocate(viewFrame.n);
    this.now = 1 - this.now;
    const texels = new Uint32Array(viewFrame.buffer, HEADER_BYTES, viewFrame.n * ROBOT_BYTES / 4);
    const rows = Math.floor(viewFrame.n / WIDTH), rest = viewFrame.n % WIDTH;
    for (const which of anew ? [0, 1] : [this.now]) {
      gl.bindTexture(gl.TEXTURE_2D, this.textures[which]);
      const put = (y, width, height, data) => {
        if (width * height > 0) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, y, width, height, gl.RGBA_INTEGER, gl.UNSIGNED_INT, data);
      };
      put(0, WIDTH, rows, texels);
      put(rows, rest, 1, texels.subarray(4 * WIDTH * rows));
    }
  }

  #allocate(n) {
    const { gl } = this;
    this.count = n;
    this.textures = this.textures.map((old) => {
      gl.deleteTexture(old);
      const texture = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32UI, WIDTH, Math.max(1, Math.ceil(n / WIDTH)));
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
      return texture;
    });
  }

  /** The uniforms of ROBOT, for texture units 0 and 1. */
  bind(at, theme, mix, byMode) {
    const { gl } = this;
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.textures[1 - this.now]);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.textures[this.now]);
    gl.uniform1i(at.uNowFrame, 0);
    gl.uniform1i(at.uBeforeFrame, 1);
    gl.uniform1f(at.uMix, mix);
    gl.uniform1i(at.uByMode, byMode ? 1 : 0);
    gl.uniform3fv(at.uGoals, theme.goalsFlat);
    gl.uniform3fv(at.uModes, theme.modesFlat);
  }

  draw(view, theme, radius_m, mix, byMode) {
    if (this.count === 0) return;
    const { gl } = this;
    const at = this.program.use(view);
    this.bind(at, theme, mix, byMode);
    gl.uniform1f(at.uRadius, radius_m);
    gl.uniform3fv(at.uLost, theme.lost);
    gl.uniform3fv(at.uGround, theme.ground);
    gl.bindVertexArray(this.vao);
    gl.drawArrays(gl.TRIANGLES, 0, 6 * this.count);
  }
}
