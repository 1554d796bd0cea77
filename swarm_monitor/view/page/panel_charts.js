// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The run over time, drawn by dygraphs; the time shown on the map is a line of our own, which costs no redraw.
import { byId, make, put } from './text.js';

const CHARTS = [
  { title: 'Nearest gap', unit: 'm', columns: ['nearest_gap_m'], colours: ['--chart-0'], digits: 2 },
  { title: 'Robots', unit: '', columns: ['arrived', 'moving'], colours: ['--chart-2', '--chart-0'], digits: 0 },
  { title: 'Latency', unit: 'ms', columns: ['latency_ms'], colours: ['--chart-1'], digits: 1 },
  { title: 'Rate', unit: 'Hz', columns: ['rate_hz'], colours: ['--chart-3'], digits: 1 },
];

export class Charts {
  #names = [];
  #rows = [];
  #charts = [];
  #stale = true;
  #t = 0;

  constructor(seek) {
    this.seek = seek;
    this.box = byId('chart-list');
    this.details = byId('charts');
    this.details.addEventListener('toggle', () => this.refresh());
    new ResizeObserver(() => {
      for (const { graph } of this.#charts) graph?.resize();
      this.mark(this.#t);
    }).observe(this.box);
  }

  clear() {
    this.#rows = [];
    this.#stale = true;
  }

  add({ from, names, rows }) {
    this.#names = names;
    this.#rows.length = Math.min(this.#rows.length, from);
    this.#rows.push(...rows);
    this.#stale = true;
  }

  /** Draws new rows if the panel is visible. */
  refresh(range = null) {
    if (range) this.range = range;
    if (!this.#stale || !this.details.open || this.#rows.length === 0) return;
    if (typeof Dygraph === 'undefined') {
      put(this.box, 'Charts need dygraphs, which the server did not send.');
      return;
    }
    this.#stale = false;
    if (this.#charts.length === 0) this.#build();
    for (const chart of this.#charts) this.#draw(chart);
    this.mark(this.#t);
  }

  /** After a change of colours. */
  restyle() {
    for (const { graph } of this.#charts) graph?.destroy();
    this.#charts = [];
    this.box.replaceChildren();
    this.#stale = true;
    this.refresh();
  }

  #build() {
    this.#charts = CHARTS.map((spec) => {
      const values = spec.columns.map((_, i) => {
        const value = make('b');
        value.style.color = `var(${spec.colours[i]})`;
        return value;
      });
      const named = values.map((value, i) =>
        make('span', {}, spec.columns.length > 1 ? `${spec.columns[i]} ` : '', value));
      const plot = make('div', { className: 'plot', role: 'img', 'aria-label': `${spec.title} over time` });
      const marker = make('div', { className: 'marker', 'aria-hidden': 'true' });
      const frame = make('div', { className: 'plot-frame' }, plot, marker);
      const whole = make('div', { className: 'chart' }, make('h3', {}, spec.title, ...named), frame);
      this.box.append(whole);
      const chart = { spec, values, plot, marker, whole, graph: null };
      frame.addEventListener('click', (event) => {
        if (chart.graph) this.seek(chart.graph.toDataXCoord(event.clientX - frame.getBoundingClientRect().left));
      });
      return chart;
    });
  }

  #draw(chart) {
    const { spec } = chart;
    const columns = spec.columns.map((name) => this.#names.indexOf(name));
    const rows = this.#rows.map((row) => [row[0], ...columns.map((at) => row[at] ?? null)]);
    // Recordings lack some columns: those are not shown.
    chart.whole.hidden = rows.every((row) => row.slice(1).every((value) => value === null));
    if (chart.whole.hidden) return;
    const first = this.range?.[0] ?? rows[0][0];
    const last = Math.max(this.range?.[1] ?? 0, rows.at(-1)[0], first + 1);
    if (chart.graph) {
      chart.graph.updateOptions({ file: rows, dateWindow: [first, last] });
      return;
    }
    const style = getComputedStyle(document.documentElement);
    const axis = { axisLineColor: style.getPropertyValue('--line'), gridLineColor: style.getPropertyValue('--line') };
    chart.graph = new Dygraph(chart.plot, rows, {
      labels: ['t', ...spec.columns],
      colors: spec.colours.map((name) => style.getPropertyValue(name).trim()),
      dateWindow: [first, last],
      legend: 'never',
      interactionModel: {},
      highlightCircleSize: 2,
      strokeWidth: 1.5,
      includeZero: true,
      axes: {
        x: { ...axis, drawGrid: false, pixelsPerLabel: 60, axisLabelWidth: 44 },
        y: { ...axis, axisLabelWidth: 36, pixelsPerLabel: 18 },
      },
    });
  }

  mark(t) {
    this.#t = t;
    if (!this.details.open || this.#charts.length === 0 || this.#rows.length === 0) return;
    const row = this.#rowAt(t);
    for (const { graph, marker, spec, values } of this.#charts) {
      if (!graph) continue;
      const x = graph.toDomXCoord(t);
      const area = graph.getArea();
      marker.hidden = !(x >= area.x && x <= area.x + area.w + 1);
      marker.style.transform = `translateX(${x.toFixed(1)}px)`;
      values.forEach((element, i) => {
        const value = row[this.#names.indexOf(spec.columns[i])] ?? null;
        put(element, value === null ? '–' : `${value.toFixed(spec.digits)} ${spec.unit}`);
      });
    }
  }

  #rowAt(t) {
    let low = 0, high = this.#rows.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.#rows[middle][0] <= t) low = middle;
      else high = middle - 1;
    }
    return this.#rows[low];
  }
}
