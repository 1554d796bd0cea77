// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// What does not move is drawn once and copied under every frame, so that a goal of hundreds of ellipses costs nothing.
import { Program } from './draw_gl.js';

// A copy by texture: blitFramebuffer() to a canvas without alpha is refused by some drivers.
const VERTEX = 'void main() { gl_Position = vec4(corner(), 0.0, 1.0); }';
const FRAGMENT = `
uniform sampler2D uStill;
void main() { oColour = texelFetch(uStill, ivec2(gl_FragCoord.xy), 0); }`;

export class Backdrop {
  #key = '';

  constructor(gl) {
    this.gl = gl;
    this.program = new Program(gl, VERTEX, FRAGMENT);
    this.vao = gl.createVertexArray();
    this.frame = gl.createFramebuffer();
    this.texture = null;
  }

  /** The next draw() draws anew. */
  forget() {
    this.#key = '';
  }

  /** Fills the canvas: by `paint()` if the view or `what` changed, and else from memory. */
  draw(view, what, paint) {
    const { gl } = this;
    gl.viewport(0, 0, view.width, view.height);
    const key = `${what}/${Object.values(view).join('/')}`;
    if (key !== this.#key) {
      gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
      this.#fit(view.width, view.height);
      paint();
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      this.#key = key;
    }
    gl.uniform1i(this.program.use(view).uStill, 0);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.bindVertexArray(this.vao);
    gl.disable(gl.BLEND);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    gl.enable(gl.BLEND);
  }

  #fit(width, height) {
    if (width === this.width && height === this.height) return;
    const { gl } = this;
    [this.width, this.height] = [width, height];
    gl.deleteTexture(this.texture);
    this.texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, width, height);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.texture, 0);
  }
}
