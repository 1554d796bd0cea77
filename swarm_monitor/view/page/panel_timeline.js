// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Play, seek and rate of a recording; of a live run, its clock.
import { byId, clock, make, put } from './text.js';

const MOST_MARKS = 200;

export class Timeline {
  constructor(player, changed) {
    this.player = player;
    this.slider = byId('slider');
    this.slider.addEventListener('input', () => {
      player.seek(Number(this.slider.value));
      changed();
    });
    byId('play').addEventListener('click', () => {
      player.toggle();
      changed();
    });
    byId('rate-choice').addEventListener('change', (event) => {
      player.rate = Number(event.target.value);
    });
  }

  show(shown_t) {
    const { player, slider } = this;
    byId('recorded').hidden = player.live;
    byId('live-clock').hidden = !player.live;
    if (player.live) return put(byId('live-time'), clock(shown_t));
    if (Number(slider.min) !== player.begin) slider.min = player.begin;
    if (Number(slider.max) !== player.end) slider.max = player.end;
    slider.value = player.t;
    const part = (player.t - player.begin) / Math.max(player.end - player.begin, 1e-9);
    slider.style.setProperty('--part', `${(100 * part).toFixed(2)}%`);
    slider.setAttribute('aria-valuetext', `${clock(player.t)} of ${clock(player.end)}`);
    put(byId('time'), clock(player.t));
    put(byId('end'), clock(player.end));
    byId('play').setAttribute('aria-label', player.playing ? 'Pause' : 'Play');
    byId('play').dataset.playing = player.playing;
  }

  /** Warnings and errors, above the slider. */
  marks(events) {
    const { begin, end } = this.player;
    const grave = events.filter((e) => e.severity !== 'info').slice(0, MOST_MARKS);
    byId('marks').replaceChildren(...grave.map((event) => {
      const mark = make('i', { className: event.severity });
      mark.style.left = `${100 * Math.min(Math.max((event.t - begin) / Math.max(end - begin, 1e-9), 0), 1)}%`;
      return mark;
    }));
  }
}
