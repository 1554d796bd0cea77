// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0

// Recordings, read by the format's own library and decoded by their own IDL, hold what `swarm_monitor cat` prints.
// SWARM_RECORDING: the file. SWARM_RUN_DIR: its run, whose robot logs (and bus.mcap, if there is one) are read too.
// SWARM_BIN: the programs.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { createInterface } from 'node:readline';
import { after, test } from 'node:test';
import { differences, readerOf, shown, sizeByIdl } from './idl_messages.mjs';
import { openIndexed, readStream } from './recording.mjs';

const { SWARM_BIN, SWARM_RECORDING, SWARM_RUN_DIR } = process.env;
assert.ok(SWARM_RECORDING && SWARM_BIN, 'SWARM_RECORDING: a recording; SWARM_BIN: where the programs are');
const MOST_SHOWN = 20;

const scratch = mkdtempSync(join(tmpdir(), 'recording-test-'));
after(() => rmSync(scratch, { recursive: true }));

const bytes = readFileSync(SWARM_RECORDING);
const whole = readStream(bytes);

/** Asserts that `cat` prints just these messages. */
async function assertSameAsCat(file, messages, expectedCode = 0) {
  const cat = spawn(join(SWARM_BIN, 'swarm_monitor'), ['cat', file], { stdio: ['ignore', 'pipe', 'pipe'] });
  const exit = once(cat, 'close');
  let complaint = '';
  cat.stderr.on('data', (text) => { complaint += text; });
  const wrong = [];
  let lines = 0;
  for await (const line of createInterface({ input: cat.stdout })) {
    const message = messages[lines++];
    if (!message || wrong.length >= MOST_SHOWN) continue;
    const read = {
      topic: message.channel.topic, type: message.schema.name, log_time_ns: message.logTime,
      publish_time_ns: message.publishTime, sequence: message.sequence,
      data: readerOf(message.schema.name, new TextDecoder().decode(message.schema.data)).readMessage(message.data),
    };
    for (const { path, expected, read: value } of differences(JSON.parse(line), read)) {
      wrong.push(`message ${lines - 1} of ${read.topic}: ${path}: cat prints ${shown(expected)}, the IDL reads ${shown(value)}`);
    }
  }
  const [code] = await exit;
  assert.equal(code, expectedCode, complaint);
  assert.deepEqual(wrong.slice(0, MOST_SHOWN), []);
  assert.equal(lines, messages.length, `cat printed ${lines} lines for ${messages.length} messages`);
}

const identity = (message) => `${message.logTime} ${message.channelId} ${message.sequence} ${message.data.length}`;

function assertBegins(messages, all) {
  messages.forEach((message, i) => {
    assert.equal(identity(message), identity(all[i]));
    assert.ok(Buffer.from(message.data).equals(all[i].data), `message ${i} has other bytes`);
  });
}

test('its stream ends well, and everything is CDR described by IDL', () => {
  assert.ok(whole.done);
  assert.equal(whole.bytesLeft, 0);
  assert.ok(whole.messages.length > 0);
  for (const channel of whole.channels.values()) {
    assert.equal(channel.messageEncoding, 'cdr', channel.topic);
    assert.equal(whole.schemas.get(channel.schemaId).encoding, 'omgidl', channel.topic);
    assert.match(whole.schemas.get(channel.schemaId).name, /^swarm::(wire|blackbox)::/);
  }
});

test('its summary lists its contents', async () => {
  const { statistics, chunkIndexes, channelsById, schemasById } = await openIndexed(bytes);
  assert.equal(statistics.messageCount, BigInt(whole.messages.length));
  assert.equal(statistics.chunkCount, whole.chunks.length);
  assert.equal(statistics.attachmentCount, whole.attachments.length);
  assert.deepEqual(channelsById, whole.channels);
  assert.deepEqual(schemasById, whole.schemas);
  const times = whole.messages.map((message) => message.logTime).sort((a, b) => (a < b ? -1 : a > b ? 1 : 0));
  assert.equal(statistics.messageStartTime, times[0]);
  assert.equal(statistics.messageEndTime, times.at(-1));
  for (const { id, topic } of whole.channels.values()) {
    const count = whole.messages.filter((message) => message.channelId === id).length;
    assert.equal(statistics.channelMessageCounts.get(id) ?? 0n, BigInt(count), topic);
  }
  assert.equal(chunkIndexes.length, whole.chunks.length);
  const CHUNK = 0x06;
  chunkIndexes.forEach((index, i) => {
    const chunk = whole.chunks[i], at = Number(index.chunkStartOffset);
    assert.equal(bytes[at], CHUNK);
    assert.equal(index.chunkLength, bytes.readBigUInt64LE(at + 1) + 9n);
    assert.equal(index.compression, chunk.compression);
    assert.equal(index.compressedSize, BigInt(chunk.records.byteLength));
    assert.equal(index.uncompressedSize, chunk.uncompressedSize);
    assert.equal(index.messageStartTime, chunk.messageStartTime);
    assert.equal(index.messageEndTime, chunk.messageEndTime);
  });
});

test('its index leads to every message', async () => {
  const reader = await openIndexed(bytes);
  const collect = async (wanted) => {
    const found = [];
    for await (const message of reader.readMessages({ ...wanted, validateCrcs: true })) found.push(message);
    return found;
  };
  const all = await collect();
  all.forEach((message, i) => assert.ok(i === 0 || all[i - 1].logTime <= message.logTime, 'in order of time'));
  assert.deepEqual(all.map(identity).sort(), whole.messages.map(identity).sort());

  // The middle third of the time, topic by topic.
  const { messageStartTime: begin, messageEndTime: end } = reader.statistics;
  const startTime = begin + (end - begin) / 3n, endTime = end - (end - begin) / 3n;
  for (const { topic } of whole.channels.values()) {
    const expected = whole.messages.filter((message) =>
      message.channel.topic === topic && message.logTime >= startTime && message.logTime <= endTime);
    assert.deepEqual((await collect({ topics: [topic], startTime, endTime })).map(identity).sort(), expected.map(identity).sort());
  }
});

test('it carries its mission', async () => {
  const reader = await openIndexed(bytes);
  const indexed = [];
  for await (const attachment of reader.readAttachments({ validateCrcs: true })) indexed.push(attachment);
  assert.deepEqual(indexed, whole.attachments);
  const mission = whole.attachments.find((attachment) => attachment.name === 'mission.resolved.yaml');
  assert.ok(mission, `only ${whole.attachments.map((attachment) => attachment.name)}`);
  assert.match(new TextDecoder().decode(mission.data), /^robots:/m);
});

test('every message decodes by its IDL to what cat prints', () => assertSameAsCat(SWARM_RECORDING, whole.messages));

test('the IDL accounts for every byte', () => {
  for (const { channel, schema, data } of whole.messages) {
    // DDS pads to a multiple of four, and the padding between fields is undefined: only sizes are compared.
    const padding = data.length - sizeByIdl(schema.name, new TextDecoder().decode(schema.data), data);
    assert.ok(padding >= 0 && padding < 4, `${channel.topic}: ${padding} bytes that no field has`);
  }
});

const bus = SWARM_RUN_DIR && join(SWARM_RUN_DIR, 'bus.mcap');
for (const file of [SWARM_RECORDING, bus].filter((name) => name && existsSync(name))) {
  test(`${basename(file)}, cut, is read up to the cut`, async () => {
    const full = readFileSync(file);
    const { messages } = readStream(full);
    const { chunkIndexes } = await openIndexed(full);
    // Behind the last chunk there is nothing to lose: 60 % of the file may be all messages.
    const last = chunkIndexes.at(-1);
    const cuts = [Math.floor(0.6 * full.length), Number(last.chunkStartOffset + last.chunkLength) - 1];
    for (const cut of cuts) {
      const kept = chunkIndexes.filter((index) => Number(index.chunkStartOffset + index.chunkLength) <= cut).length;
      const copy = join(scratch, `cut-${cut}-${basename(file)}`);
      writeFileSync(copy, full.subarray(0, cut));
      const read = readStream(full.subarray(0, cut));
      assert.equal(read.done, false);
      assert.equal(read.messages.length, messages.filter((message) => message.chunk < kept).length);
      assertBegins(read.messages, messages);
      await assertSameAsCat(copy, read.messages);
    }
  });
}

test('a flipped bit is noticed, and costs no more than its chunk', async () => {
  const { chunkIndexes } = await openIndexed(bytes);
  const broken = chunkIndexes.at(Math.floor(chunkIndexes.length / 2));
  const copy = Buffer.from(bytes);
  copy[Number(broken.chunkStartOffset + broken.chunkLength) - 10] ^= 0x10;
  assert.throws(() => readStream(copy));
  const file = join(scratch, 'flipped.mcap');
  writeFileSync(file, copy);
  const number = chunkIndexes.indexOf(broken);
  await assertSameAsCat(file, whole.messages.filter((message) => message.chunk !== number), 1);
});

test('robot logs are read, those of killed processes up to their end', async (t) => {
  if (!SWARM_RUN_DIR) return t.skip('SWARM_RUN_DIR is not given');
  const folder = join(SWARM_RUN_DIR, 'blackbox');
  const boxes = readdirSync(folder).filter((name) => /^robot-.*\.mcap$/.test(name)).sort();
  assert.ok(boxes.length > 0);
  for (const name of boxes) await assertSameAsCat(join(folder, name), readStream(readFileSync(join(folder, name))).messages);

  const box = readFileSync(join(folder, boxes[0]));
  const { messages } = readStream(box);
  // Inside the end's magic, its footer, the last record; then somewhere.
  for (const lost of [1, 20, 50, 100, 1000, Math.floor(box.length / 2)]) {
    const cut = join(scratch, `lost-${lost}.mcap`);
    writeFileSync(cut, box.subarray(0, box.length - lost));
    const read = readStream(box.subarray(0, box.length - lost));
    assert.equal(read.done, false);
    if (lost <= 1000) assert.ok(read.messages.length > 0);
    assertBegins(read.messages, messages);
    await assertSameAsCat(cut, read.messages);
  }
});
