// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The clock of a recording. A live run has none: it shows the newest frame.

export class Player {
  live = true;
  begin = 0;
  end = 0;
  t = 0;
  playing = false;
  rate = 1;
  sought = false;  // since the last frame: the next one does not continue it
  #started = false;

  /** From a scene. The first one of a recording starts it, unless `still`. */
  setRange(scene, still) {
    this.live = scene.live;
    this.begin = scene.begin;
    this.end = Math.max(scene.end, scene.begin);
    if (this.live || this.#started) return;
    this.#started = true;
    this.t = this.begin;
    this.playing = !still;
  }

  advance(elapsed_s) {
    if (this.live || !this.playing) return;
    this.t = Math.min(this.t + elapsed_s * this.rate, this.end);
    if (this.t >= this.end) this.playing = false;
  }

  toggle() {
    if (this.live) return;
    if (!this.playing && this.t >= this.end) this.seek(this.begin);
    this.playing = !this.playing;
  }

  seek(t) {
    if (this.live || !Number.isFinite(t)) return;
    this.t = Math.min(Math.max(t, this.begin), this.end);
    this.sought = true;
  }
}
