// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Filled polygons: all obstacles in one draw call.
import { attributes, Program } from './draw_gl.js';
import { triangulate } from './triangulate.js';

export class Fills {
  constructor(gl) {
    this.gl = gl;
    this.program = new Program(gl,
      'layout(location = 0) in vec2 aAt;\nvoid main() { gl_Position = toClip(aAt, vec2(0.0)); }',
      'uniform vec3 uColour;\nvoid main() { oColour = vec4(uColour, 1.0); }');
    this.vao = gl.createVertexArray();
    this.buffer = gl.createBuffer();
    this.count = 0;
    gl.bindVertexArray(this.vao);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    attributes(gl, 8, [[0, 2, gl.FLOAT, 0]]);
  }

  set(polygons) {
    const corners = polygons.flatMap((points) => triangulate(points).flatMap((i) => points[i]));
    this.count = corners.length / 2;
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.buffer);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, new Float32Array(corners), this.gl.STATIC_DRAW);
  }

  draw(view, rgb) {
    if (this.count === 0) return;
    this.gl.uniform3fv(this.program.use(view).uColour, rgb);
    this.gl.bindVertexArray(this.vao);
    this.gl.drawArrays(this.gl.TRIANGLES, 0, this.count);
  }
}
