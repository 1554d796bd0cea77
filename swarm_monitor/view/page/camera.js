// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// What part of the world the map shows. Metres, y up, and CSS pixels from the canvas's upper left corner.

const LEAST_SCALE = 0.02, MOST_SCALE = 2000;  // CSS px per metre

export class Camera {
  cx = 0;
  cy = 0;
  scale = 1;
  width = 1;
  height = 1;
  #bounds = [[0, 0], [1, 1]];
  #fitted = true;

  /** A map that shows the whole world goes on doing so. */
  resize(width, height) {
    this.width = Math.max(1, width);
    this.height = Math.max(1, height);
    if (this.#fitted) this.fit();
  }

  setBounds(bounds) {
    const same = JSON.stringify(bounds) === JSON.stringify(this.#bounds);
    this.#bounds = bounds;
    if (!same) this.fit();
  }

  fit() {
    const [[x0, y0], [x1, y1]] = this.#bounds;
    const margin = Math.min(28, 0.06 * this.width);
    this.cx = 0.5 * (x0 + x1);
    this.cy = 0.5 * (y0 + y1);
    this.scale = this.#clamped(Math.min((this.width - 2 * margin) / Math.max(x1 - x0, 1e-6),
      (this.height - 2 * margin) / Math.max(y1 - y0, 1e-6)));
    this.#fitted = true;
  }

  pan(dx_px, dy_px) {
    this.cx -= dx_px / this.scale;
    this.cy += dy_px / this.scale;
    this.#fitted = false;
  }

  /** The point under (x, y) stays there. */
  zoom(factor, x_px = this.width / 2, y_px = this.height / 2) {
    const [wx, wy] = this.toWorld(x_px, y_px);
    this.scale = this.#clamped(this.scale * factor);
    const [nx, ny] = this.toWorld(x_px, y_px);
    this.cx += wx - nx;
    this.cy += wy - ny;
    this.#fitted = false;
  }

  toScreen(x, y) {
    return [this.width / 2 + (x - this.cx) * this.scale, this.height / 2 - (y - this.cy) * this.scale];
  }

  toWorld(x_px, y_px) {
    return [this.cx + (x_px - this.width / 2) / this.scale, this.cy - (y_px - this.height / 2) / this.scale];
  }

  /** 1, 2 or 5 times a power of ten: metres that take at least `least_px`. */
  roundStep(least_px) {
    const raw = least_px / this.scale;
    const power = 10 ** Math.floor(Math.log10(raw));
    return power * ([1, 2, 5].find((factor) => factor * power >= raw) ?? 10);
  }

  #clamped(scale) {
    return Math.min(Math.max(scale, LEAST_SCALE), MOST_SCALE);
  }
}
