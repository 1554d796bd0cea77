// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0

// A client of Foxglove's WebSocket protocol, by Foxglove's library. Every message is decoded by the schema that the
// server advertised.
import protocol from '@foxglove/ws-protocol';
import WebSocket from 'ws';
import { readerOf } from './idl_messages.mjs';

const TIMEOUT_MS = 60000;  // against hanging for ever; nothing is measured by it

export class Peer {
  channels = new Map();  // by topic
  messages = [];  // { topic, id, timestamp, data }, in order of arrival
  statuses = [];
  times = [];
  closed = false;
  #topics = new Map();  // by subscription
  #waiting = new Set();

  constructor(url, subprotocol) {
    this.socket = new WebSocket(url, [subprotocol]);
    this.client = new protocol.FoxgloveClient({ ws: this.socket });
    const on = (event, take) => this.client.on(event, (what) => {
      take(what);
      for (const check of this.#waiting) check();
    });
    on('error', (error) => { this.error = error; });
    on('close', () => { this.closed = true; });
    on('serverInfo', (info) => { this.info = info; });
    on('advertise', (all) => all.forEach((channel) => this.channels.set(channel.topic, channel)));
    on('status', (status) => this.statuses.push(status));
    on('time', ({ timestamp }) => this.times.push(timestamp));
    on('message', ({ subscriptionId, timestamp, data }) => {
      const topic = this.#topics.get(subscriptionId);
      const { schemaName, schema } = this.channels.get(topic);
      this.messages.push({ topic, id: subscriptionId, timestamp, data: readerOf(schemaName, schema).readMessage(data) });
    });
  }

  /** Connected, with server information and channels. */
  static async open(url, subprotocol = 'foxglove.sdk.v1') {
    const peer = new Peer(url, subprotocol);
    await peer.until(() => peer.info && peer.channels.size > 0, 'server info and channels');
    return peer;
  }

  /** What `condition` gives as soon as it gives something, looked at whenever anything has come. */
  until(condition, what) {
    return new Promise((resolve, reject) => {
      const end = (finish, result) => {
        clearTimeout(timer);
        this.#waiting.delete(check);
        finish(result);
      };
      const check = () => {
        const result = condition();
        if (result) end(resolve, result);
        else if (this.error) end(reject, this.error);
        else if (this.closed) end(reject, new Error(`closed while waiting for ${what}`));
      };
      const timer = setTimeout(() => end(reject, new Error(`no ${what} came`)), TIMEOUT_MS);
      this.#waiting.add(check);
      check();
    });
  }

  subscribe(topic) {
    const id = this.client.subscribe(this.channels.get(topic).id);
    this.#topics.set(id, topic);
    return id;
  }

  /** The next message of this topic, from now on, that is accepted. */
  next(topic, accept = () => true) {
    const from = this.messages.length;
    return this.until(() => this.messages.slice(from).find((m) => m.topic === topic && accept(m)), `message of ${topic}`);
  }

  /** Sends a frame and waits for the status that answers it. */
  async answerTo(frame, options) {
    const from = this.statuses.length;
    this.socket.send(frame, options);
    await this.until(() => this.statuses.length > from, `answer to ${String(frame).slice(0, 60)}`);
    return this.statuses[from];
  }

  async close() {
    this.client.close();
    await this.until(() => this.closed, 'end');
  }
}
