// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// What happened: of a live run the newest first, of a recording in order and with a click to go there.
import { byId, clock, make, put } from './text.js';

const MOST_SHOWN = 200;
const GRAVITY = { info: 0, warning: 1, error: 2 };

export class Events {
  #all = [];
  #shown = [];  // [event, element]
  #live = true;
  #first = 0;
  #passed = -1;
  #least = 0;

  constructor(seek) {
    this.seek = seek;
    byId('severity-choice').addEventListener('change', (event) => {
      this.#least = Number(event.target.value);
      this.#render();
    });
  }

  get all() {
    return this.#all;
  }

  clear() {
    this.#all = [];
    this.#render();
  }

  add(events, live) {
    this.#all.push(...events);
    this.#live = live;
    this.#render();
  }

  /** Of a recording: which ones have happened by `t`. */
  show(t) {
    if (this.#live) return;
    const wanted = this.#wanted();
    let passed = wanted.length;
    while (passed > 0 && wanted[passed - 1].t > t + 1e-6) passed -= 1;
    if (passed === this.#passed) return;
    this.#passed = passed;
    const first = Math.max(0, Math.min(passed - MOST_SHOWN / 2, wanted.length - MOST_SHOWN));
    if (Math.abs(first - this.#first) > MOST_SHOWN / 4) this.#render();
    this.#shown.forEach(([event, element]) => element.classList.toggle('future', event.t > t + 1e-6));
    const list = byId('event-list');
    const current = this.#shown[Math.min(passed - 1 - this.#first, this.#shown.length - 1)]?.[1];
    if (!current || list.matches(':hover, :focus-within')) return;
    list.scrollTop = current.offsetTop - list.clientHeight / 2;
  }

  #wanted() {
    return this.#least === 0 ? this.#all : this.#all.filter((e) => (GRAVITY[e.severity] ?? 0) >= this.#least);
  }

  #render() {
    const wanted = this.#wanted();
    const around = this.#live ? wanted.length : this.#passed;
    this.#first = Math.max(0, Math.min(around - MOST_SHOWN / 2, wanted.length - MOST_SHOWN));
    this.#shown = wanted.slice(this.#first, this.#first + MOST_SHOWN).map((e) => [e, this.#row(e)]);
    if (this.#live) this.#shown.reverse();
    byId('event-list').replaceChildren(...this.#shown.map(([, element]) => element));
    const hidden = wanted.length - this.#shown.length;
    put(byId('event-count'), hidden > 0 ? `${this.#shown.length} of ${wanted.length}` : String(wanted.length));
    byId('event-none').hidden = wanted.length > 0;
  }

  #row(event) {
    const severity = event.severity in GRAVITY ? event.severity : 'info';
    const parts = [
      make('span', { className: 'when' }, clock(event.t)),
      make('span', { className: `severity ${severity}` }, severity),
      make('span', { className: 'what' },
        make('b', {}, event.code), ` ${event.text} `, make('span', { className: 'soft' }, event.source)),
    ];
    if (this.#live) return make('li', {}, make('div', { className: 'event' }, ...parts));
    const button = make('button', { className: 'event', type: 'button', title: 'Go there' }, ...parts);
    button.addEventListener('click', () => this.seek(event.t));
    return make('li', {}, button);
  }
}
