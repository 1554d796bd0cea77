// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The map: one layer after the other, a draw call each, back to front.
import { Backdrop } from './draw_backdrop.js';
import { Ellipses, ellipseProgram } from './draw_ellipses.js';
import { Fills } from './draw_fills.js';
import { Ground } from './draw_ground.js';
import { lineProgram, Lines } from './draw_lines.js';
import { Robots } from './draw_robots.js';
import { Trails } from './draw_trails.js';
import { showChosen, showMixture, showObstacles, showPlan, showRegions } from './shapes.js';

const MOST_PIXEL_RATIO = 2;  // beyond it costs fill rate and shows nothing

export class SwarmMap {
  /** Throws if there is no WebGL2. */
  constructor(canvas, camera) {
    this.canvas = canvas;
    this.camera = camera;
    this.gl = canvas.getContext('webgl2', {
      alpha: false, antialias: false, depth: false, stencil: false, powerPreference: 'high-performance',
    });
    if (!this.gl) throw new Error('no WebGL2');
    this.scene = null;
    this.viewFrame = null;
    this.layers = { trails: true, plan: true, mixture: true, cells: false };
    this.byMode = false;
    this.build();
  }

  /** Makes everything on the GPU; again after a lost context. */
  build() {
    const { gl } = this;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    this.backdrop = new Backdrop(gl);
    const lines = lineProgram(gl), ellipses = ellipseProgram(gl);
    this.ground = new Ground(gl);
    this.fills = new Fills(gl);
    this.outlines = new Lines(gl, lines);
    this.circles = new Ellipses(gl, ellipses);
    this.legs = new Lines(gl, lines);
    this.nodes = new Ellipses(gl, ellipses);
    this.regions = new Ellipses(gl, ellipses);
    this.mixture = new Ellipses(gl, ellipses);
    this.trails = new Trails(gl);
    this.robots = new Robots(gl);
    this.chosenLines = new Lines(gl, lines);
    this.chosenRings = new Ellipses(gl, ellipses);
    if (this.theme) this.setTheme(this.theme);
    if (this.viewFrame) this.setViewFrame(this.viewFrame, true, true);
  }

  setTheme(theme) {
    this.theme = theme;
    this.backdrop.forget();
    if (this.scene) this.setScene(this.scene);
    if (this.viewFrame) showMixture(this.viewFrame, theme, this.mixture);
  }

  setScene(scene) {
    this.scene = scene;
    this.camera.setBounds(scene.bounds);
    showObstacles(scene, this.theme, this.fills, this.outlines, this.circles);
    showPlan(scene, this.theme, this.legs, this.nodes);
    showRegions(scene, this.theme, this.regions);
    this.backdrop.forget();
  }

  /** `fresh`: whether the frame is of another time. `jumped`: whether it does not continue the last one. */
  setViewFrame(viewFrame, fresh, jumped) {
    this.viewFrame = viewFrame;
    if (!fresh) return;
    this.robots.set(viewFrame);
    if (jumped) this.trails.clear();
    this.trails.add(viewFrame);
    showMixture(viewFrame, this.theme, this.mixture);
  }

  /** Matches the canvas to its size on the page. */
  resize() {
    const px = Math.min(window.devicePixelRatio || 1, MOST_PIXEL_RATIO);
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.canvas.width = Math.max(1, Math.round(width * px));
    this.canvas.height = Math.max(1, Math.round(height * px));
    this.camera.resize(width, height);
  }

  /** `mix`: 0 shows the frame before, 1 the newest. `chosen`: null or what showChosen() takes. */
  draw(mix, chosen) {
    const { camera, theme, scene, layers } = this;
    const px = this.canvas.width / camera.width;
    const view = {
      cx: camera.cx, cy: camera.cy, scale: camera.scale * px, width: this.canvas.width, height: this.canvas.height, px,
    };
    this.backdrop.draw(view, `${layers.plan}/${layers.cells}`, () => this.#drawStill(view));
    if (!scene) return;
    if (layers.mixture) this.mixture.draw(view);
    if (layers.trails) this.trails.draw(view, theme, this.robots, mix, this.byMode);
    showChosen(chosen, scene, camera, theme, this.chosenLines, this.chosenRings);
    this.chosenLines.draw(view);
    this.robots.draw(view, theme, scene.radius_m, mix, this.byMode);
    this.chosenRings.draw(view);
  }

  /** What changes with the scene and the camera only. */
  #drawStill(view) {
    const { gl, camera, theme, scene, layers } = this;
    gl.clearColor(...theme.outside, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    if (!scene) return;
    this.ground.draw(view, theme, scene, camera.roundStep(70), layers.cells ? scene.cell_m ?? 0 : 0);
    this.fills.draw(view, theme.obstacle);
    this.circles.draw(view);
    this.outlines.draw(view);
    if (layers.plan) {
      this.legs.draw(view);
      this.nodes.draw(view);
    }
    this.regions.draw(view);
  }
}
