// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Where robots were in the last seconds: a ring of snapshots in a texture, one layer each, read by the vertex
// shader. A snapshot costs one upload of 8 bytes a robot; drawing costs no upload at all.
import { Program } from './draw_gl.js';
import { ROBOT } from './draw_robots.js';

const TRAIL_S = 10;
const SNAPSHOTS = 20;
const MANY = 2000;  // robots whose trails take half the snapshots: each is a line a robot
const WIDTH = 1024;
const MISSING = 1e30;

const VERTEX = `${ROBOT}
uniform highp sampler2DArray uPast;
uniform int uNewest;
uniform int uCount;
uniform float uAlpha;
out vec4 vColour;
// 0: now; 1: the newest snapshot; and so on.
vec2 past(int id, int k) {
  if (k == 0) return position();
  int layer = (uNewest - (k - 1) + ${SNAPSHOTS}) % ${SNAPSHOTS};
  return texelFetch(uPast, ivec3(id % ${WIDTH}, id / ${WIDTH}, layer), 0).xy;
}
void main() {
  int end = gl_VertexID & 1;
  int id = (gl_VertexID >> 1) / uCount;
  int k = (gl_VertexID >> 1) % uCount + end;
  read(id);
  vec2 at = past(id, k);
  // A robot not received then has no trail there: the line shrinks to nothing.
  if (at.x > 1e29) at = past(id, end == 1 ? k - 1 : k + 1);
  if (!drawn() || at.x > 1e29) { gl_Position = kNowhere; return; }
  float alpha = uAlpha * (1.0 - float(k) / float(uCount + 1));
  vColour = vec4(colour() * alpha, alpha);
  gl_Position = toClip(at, vec2(0.0));
}`;

export class Trails {
  constructor(gl) {
    this.gl = gl;
    this.program = new Program(gl, VERTEX, 'in vec4 vColour;\nvoid main() { oColour = vColour; }');
    this.texture = null;
    this.n = 0;
    this.clear();
  }

  clear() {
    this.newest = -1;
    this.count = 0;
    this.last_t = -Infinity;
  }

  /** Takes a snapshot if the last one is old enough. Going back in time begins anew. */
  add(viewFrame) {
    if (viewFrame.n !== this.n) this.#allocate(viewFrame.n);
    if (viewFrame.t < this.last_t || viewFrame.t > this.last_t + TRAIL_S) this.clear();
    if (viewFrame.n === 0 || viewFrame.t < this.last_t + TRAIL_S / this.keep) return;
    this.last_t = viewFrame.t;
    this.newest = (this.newest + 1) % SNAPSHOTS;
    this.count = Math.min(this.count + 1, this.keep);
    const { robots, info } = viewFrame;
    for (let i = 0; i < this.n; ++i) {
      const drawn = (info[16 * i + 14] & 5) !== 0;
      this.staging[2 * i] = drawn ? robots[4 * i] : MISSING;
      this.staging[2 * i + 1] = drawn ? robots[4 * i + 1] : MISSING;
    }
    const { gl } = this;
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.texture);
    gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, this.newest, WIDTH, this.rows, 1, gl.RG, gl.FLOAT, this.staging);
  }

  #allocate(n) {
    const { gl } = this;
    this.n = n;
    this.keep = n > MANY ? SNAPSHOTS / 2 : SNAPSHOTS;
    this.rows = Math.max(1, Math.ceil(n / WIDTH));
    this.staging = new Float32Array(2 * WIDTH * this.rows);
    this.clear();
    gl.deleteTexture(this.texture);
    this.texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.texture);
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.RG32F, WIDTH, this.rows, SNAPSHOTS);
    for (const key of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
      gl.texParameteri(gl.TEXTURE_2D_ARRAY, key, gl.NEAREST);
    }
  }

  draw(view, theme, robots, mix, byMode) {
    if (this.count === 0 || robots.count !== this.n) return;
    const { gl } = this;
    const at = this.program.use(view);
    robots.bind(at, theme, mix, byMode);
    gl.activeTexture(gl.TEXTURE2);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.texture);
    gl.activeTexture(gl.TEXTURE0);
    gl.uniform1i(at.uPast, 2);
    gl.uniform1f(at.uAlpha, Math.min(0.55, 0.55 * Math.sqrt(600 / this.n)));  // thousands would cover the map
    gl.uniform1i(at.uNewest, this.newest);
    gl.uniform1i(at.uCount, this.count);
    gl.bindVertexArray(robots.vao);
    gl.drawArrays(gl.LINES, 0, 2 * this.count * this.n);
  }
}
