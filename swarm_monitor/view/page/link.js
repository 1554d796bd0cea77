// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The connection: requests one frame at a time and reconnects by itself.

const PROTOCOL = 'swarmflow.view.v1';
const LONGEST_WAIT_S = 10;

export class Link {
  connected = false;
  #socket = null;
  #asked = false;
  #wait_s = 1;

  /** `on`: {open(), message(object), picture(buffer), status(text, kind)}; kind 'good', 'waiting' or 'bad'. */
  constructor(on) {
    this.on = on;
    this.#connect();
  }

  /** True if a frame can be requested. */
  get idle() {
    return this.connected && !this.#asked;
  }

  ask(t) {
    this.#asked = true;
    this.send(t === null ? { op: 'frame' } : { op: 'frame', t });
  }

  send(object) {
    if (this.#socket.readyState !== WebSocket.OPEN) return false;
    this.#socket.send(JSON.stringify(object));
    return true;
  }

  #connect() {
    this.on.status('connecting', 'waiting');
    const url = new URL('/ws', location.href);
    url.protocol = url.protocol.replace('http', 'ws');
    const socket = new WebSocket(url, PROTOCOL);
    socket.binaryType = 'arraybuffer';
    this.#socket = socket;
    socket.onopen = () => {
      this.connected = true;
      this.#asked = false;
      this.#wait_s = 1;
      this.on.status('connected', 'good');
      this.on.open();
    };
    socket.onmessage = ({ data }) => this.#receive(data);
    socket.onclose = () => {
      this.connected = false;
      this.#retry();
    };
  }

  #receive(data) {
    try {
      if (typeof data === 'string') {
        this.on.message(JSON.parse(data));
      } else {
        this.#asked = false;
        this.on.viewFrame(data);
      }
    } catch (error) {
      console.error('message not understood:', error);
    }
  }

  #retry() {
    let left = this.#wait_s;
    this.#wait_s = Math.min(this.#wait_s + 1, LONGEST_WAIT_S);
    const count = () => {
      if (left === 0) return this.#connect();
      this.on.status(`no connection, trying again in ${left} s`, 'bad');
      left -= 1;
      setTimeout(count, 1000);
    };
    count();
  }
}
