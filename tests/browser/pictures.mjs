// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A page without a browser: requests frames at a rate and prints how many arrived.
//   node pictures.mjs URL SECONDS RATE
import WebSocket from 'ws';

const [url, seconds, rate] = [process.argv[2], Number(process.argv[3]), Number(process.argv[4])];
const { host } = new URL(url);
const socket = new WebSocket(`ws://${host}/ws`, 'swarmflow.view.v1', { origin: `http://${host}` });
socket.binaryType = 'nodebuffer';
let pictures = 0;
let bytes = 0;
let waiting = false;
socket.on('message', (data, binary) => {
  bytes += data.length;
  if (!binary) return;
  pictures += 1;
  waiting = false;
});
socket.on('open', () => {
  const asking = setInterval(() => {
    if (waiting) return;
    waiting = true;
    socket.send('{"op":"frame"}');
  }, 1000 / rate);
  setTimeout(() => {
    clearInterval(asking);
    console.log(JSON.stringify({ pictures_per_s: pictures / seconds, mb_per_s: bytes / seconds / 1e6 }));
    socket.close();
  }, 1000 * seconds);
});
