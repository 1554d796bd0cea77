// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Commands to a live swarm. Shown only if the server takes them and the page was opened with a token.
import { byId, put } from './text.js';

const STOP_MS = 3000;
const TOKEN = new URLSearchParams(location.hash.slice(1)).get('token');

export class Control {
  /** `send(object)` returns whether it went out; `toolChanged(tool)`: 'goal', 'add_obstacle' or null. */
  constructor(send, toolChanged) {
    this.send = send;
    this.toolChanged = toolChanged;
    this.tool = null;
    this.enabled = false;
    for (const action of ['pause', 'resume']) byId(`do-${action}`).addEventListener('click', () => this.#order({ action }));
    byId('do-stop').addEventListener('click', () => this.#stop());
    for (const tool of ['goal', 'add_obstacle']) {
      byId(`tool-${tool}`).addEventListener('click', () => this.setTool(this.tool === tool ? null : tool));
    }
  }

  allow(scene) {
    this.enabled = scene.control === true && TOKEN !== null;
    byId('control').hidden = !this.enabled;
    if (!this.enabled) this.setTool(null);
  }

  setTool(tool) {
    this.tool = tool;
    for (const name of ['goal', 'add_obstacle']) byId(`tool-${name}`).setAttribute('aria-pressed', String(name === tool));
    put(byId('tool-hint'), tool === null ? ''
      : 'Press on the map, or focus it and press Enter for its middle. Esc puts the tool away.');
    this.toolChanged(tool);
  }

  /** Uses the tool in hand at a point of the map. */
  useAt(x, y) {
    const order = { action: this.tool, x, y };
    if (this.tool === 'add_obstacle') {
      order.radius = Number(byId('radius').value);
      if (!(order.radius > 0)) return this.answer('The radius must be more than 0 m.', 'refused');
    }
    this.#order(order);
    this.setTool(null);
  }

  answer(text, kind) {
    put(byId('answer'), text);
    byId('answer').dataset.kind = kind;
  }

  #order(order) {
    const sent = this.send({ op: 'control', token: TOKEN, ...order });
    this.answer(sent ? `${order.action.replace('_', ' ')}: sent` : 'Not sent: no connection.', sent ? 'sent' : 'refused');
  }

  // A stop cannot be taken back, so it takes two presses.
  #stop() {
    const button = byId('do-stop');
    if (this.stopTimer) {
      this.#disarm();
      return this.#order({ action: 'stop' });
    }
    put(button, 'Press again to stop');
    button.classList.add('armed');
    this.stopTimer = setTimeout(() => this.#disarm(), STOP_MS);
  }

  #disarm() {
    clearTimeout(this.stopTimer);
    this.stopTimer = null;
    put(byId('do-stop'), 'Stop');
    byId('do-stop').classList.remove('armed');
  }
}
