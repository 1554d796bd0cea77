// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The little of WebGL2 that all layers share.

// Every vertex shader begins with this: metres to clip space, and the corner of a quad.
const VERTEX = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2DArray;
precision highp usampler2D;
uniform vec2 uCentre;  // metres at the middle of the canvas
uniform float uScale;  // device pixels per metre
uniform vec2 uSize;    // device pixels
uniform float uPx;     // device pixels per CSS pixel
vec4 toClip(vec2 metres, vec2 px) {
  return vec4(((metres - uCentre) * uScale + px) * 2.0 / uSize, 0.0, 1.0);
}
vec2 corner() { return vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1) * 2.0 - 1.0; }
const vec4 kNowhere = vec4(2.0, 2.0, 2.0, 1.0);
`;

const FRAGMENT = `#version 300 es
precision highp float;
uniform float uScale;
uniform float uPx;
out vec4 oColour;  // premultiplied
`;

function shader(gl, type, source) {
  const made = gl.createShader(type);
  gl.shaderSource(made, source);
  gl.compileShader(made);
  if (!gl.getShaderParameter(made, gl.COMPILE_STATUS) && !gl.isContextLost()) {
    throw new Error(`shader: ${gl.getShaderInfoLog(made)}`);
  }
  return made;
}

/** A program and where its uniforms are. */
export class Program {
  constructor(gl, vertex, fragment) {
    this.gl = gl;
    this.handle = gl.createProgram();
    gl.attachShader(this.handle, shader(gl, gl.VERTEX_SHADER, VERTEX + vertex));
    gl.attachShader(this.handle, shader(gl, gl.FRAGMENT_SHADER, FRAGMENT + fragment));
    gl.linkProgram(this.handle);
    if (!gl.getProgramParameter(this.handle, gl.LINK_STATUS) && !gl.isContextLost()) {
      throw new Error(`program: ${gl.getProgramInfoLog(this.handle)}`);
    }
    this.at = {};
    const count = gl.getProgramParameter(this.handle, gl.ACTIVE_UNIFORMS) ?? 0;
    for (let i = 0; i < count; ++i) {
      const name = gl.getActiveUniform(this.handle, i).name;
      this.at[name.replace('[0]', '')] = gl.getUniformLocation(this.handle, name);
    }
  }

  /** Makes it current, seen through `view`: {cx, cy, scale, width, height, px} in device pixels. */
  use(view) {
    const { gl, at } = this;
    gl.useProgram(this.handle);
    gl.uniform2f(at.uCentre ?? null, view.cx, view.cy);
    gl.uniform1f(at.uScale ?? null, view.scale);
    gl.uniform2f(at.uSize ?? null, view.width, view.height);
    gl.uniform1f(at.uPx ?? null, view.px);
    return at;
  }
}

/** Binds attributes of the bound buffer: [location, size, type, offset]; bytes are read as 0..1. */
export function attributes(gl, stride, list) {
  for (const [location, size, type, offset] of list) {
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, type, type === gl.UNSIGNED_BYTE, stride, offset);
  }
}

/** A list of equal records of floats and RGBA bytes, as the GPU wants it; keeps its memory when cleared. */
export class Records {
  constructor(words) {
    this.words = words;
    this.count = 0;
    this.#grow(64);
  }

  #grow(records) {
    const old = this.bytes;
    this.floats = new Float32Array(records * this.words);
    this.bytes = new Uint8Array(this.floats.buffer);
    if (old) this.bytes.set(old);
  }

  clear() {
    this.count = 0;
  }

  /** `floats` first, then colours as [r, g, b] and alpha, all 0..1. */
  push(floats, ...colours) {
    if ((this.count + 1) * this.words > this.floats.length) this.#grow(this.count * 2);
    let word = this.count++ * this.words;
    for (const value of floats) this.floats[word++] = value;
    for (const [rgb, alpha] of colours) {
      const at = 4 * word++;
      for (let i = 0; i < 3; ++i) this.bytes[at + i] = Math.round(255 * rgb[i]);
      this.bytes[at + 3] = Math.round(255 * alpha);
    }
  }

  /** Each record four times, for the four corners of its quad. */
  corners() {
    const { words } = this;
    if (this.four === undefined || this.four.length < 4 * words * this.count) {
      this.four = new Uint32Array(4 * this.floats.length);
    }
    const from = new Uint32Array(this.floats.buffer);
    for (let i = 0; i < this.count; ++i) {
      const record = from.subarray(i * words, (i + 1) * words);
      for (let copy = 0; copy < 4; ++copy) this.four.set(record, (4 * i + copy) * words);
    }
    return this.four.subarray(0, 4 * words * this.count);
  }
}

/** Records drawn as one quad each, all in one call. Not instanced: software renderers, which have to do
 *  where there is no GPU, start anew for every instance (5000 robots took three times as long). */
export class Quads {
  constructor(gl, program, words, list) {
    this.gl = gl;
    this.program = program;
    this.records = new Records(words);
    this.indexed = 0;
    this.vao = gl.createVertexArray();
    this.buffer = gl.createBuffer();
    this.indices = gl.createBuffer();
    gl.bindVertexArray(this.vao);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.indices);
    attributes(gl, 4 * words, list);
  }

  upload() {
    const { gl, records } = this;
    gl.bindVertexArray(this.vao);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, records.corners(), gl.DYNAMIC_DRAW);
    if (records.count <= this.indexed) return;
    this.indexed = 2 * records.count;
    const list = new Uint32Array(6 * this.indexed);
    for (let i = 0; i < this.indexed; ++i) list.set([0, 1, 2, 2, 1, 3].map((corner) => 4 * i + corner), 6 * i);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, list, gl.STATIC_DRAW);
  }

  draw(view) {
    if (this.records.count === 0) return;
    this.program.use(view);
    this.gl.bindVertexArray(this.vao);
    this.gl.drawElements(this.gl.TRIANGLES, 6 * this.records.count, this.gl.UNSIGNED_INT, 0);
  }
}
