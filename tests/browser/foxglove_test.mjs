// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0

// The view as Foxglove sees it: by Foxglove's own client and decoder, against the server at SWARM_VIEW_URL, which shows a
// run that flies.
import assert from 'node:assert/strict';
import { once } from 'node:events';
import { connect } from 'node:net';
import { after, before, test } from 'node:test';
import { isDeepStrictEqual } from 'node:util';
import WebSocket from 'ws';
import { Peer } from './foxglove_peer.mjs';

assert.ok(process.env.SWARM_VIEW_URL, 'SWARM_VIEW_URL: where the view is served');
const { origin, host, hostname, port } = new URL(process.env.SWARM_VIEW_URL);
const SERVER = `ws://${host}/`;
const OWN = { '/robots': 'foxglove::PosesInFrame', '/obstacles': 'foxglove::SceneUpdate', '/mixture': 'foxglove::SceneUpdate' };
const RAW = {
  'swarm/plan': 'swarm::wire::FlowPlan', 'swarm/scene': 'swarm::wire::Scene', 'swarm/command': 'swarm::wire::Command',
  'swarm/heartbeat': 'swarm::wire::Heartbeat', 'swarm/status': 'swarm::wire::Status', 'swarm/event': 'swarm::wire::Event',
  'swarm/cell': 'swarm::wire::CellStates',
};

let peer, scene;

/** What the page receives of the map: the first frame that it gets. */
async function pageScene() {
  const socket = new WebSocket(`${SERVER}ws`, 'swarmflow.view.v1', { origin });
  const [frame] = await once(socket, 'message');
  socket.close();
  return JSON.parse(frame);
}

const ns = ({ sec, nsec }) => BigInt(sec) * 1000000000n + BigInt(nsec);

before(async () => {
  scene = await pageScene();
  assert.equal(scene.live, true, 'SWARM_VIEW_URL must show a run that flies');
  peer = await Peer.open(SERVER);
});

after(() => peer?.close());

for (const subprotocol of ['foxglove.sdk.v1', 'foxglove.websocket.v1']) {
  test(`sends server information and channels, by ${subprotocol}`, async () => {
    const other = await Peer.open(SERVER, subprotocol);
    assert.equal(other.socket.protocol, subprotocol);
    assert.equal(other.info.name, 'Swarmflow');
    assert.ok(other.info.capabilities.includes('time'));
    assert.equal(other.info.sessionId, peer.info.sessionId);
    for (const [topic, schemaName] of Object.entries({ ...OWN, ...RAW })) {
      const channel = other.channels.get(topic);
      assert.ok(channel, `no ${topic} among ${[...other.channels.keys()]}`);
      assert.deepEqual([channel.encoding, channel.schemaEncoding, channel.schemaName], ['cdr', 'omgidl', schemaName]);
    }
    other.subscribe('/robots');
    await other.next('/robots');
    await other.close();
  });
}

test('refuses what speaks another protocol, or none', async () => {
  for (const protocols of [['nonsense.v1'], []]) {
    const socket = new WebSocket(SERVER, protocols);
    const end = await Promise.race([once(socket, 'error').then(() => 'error'), once(socket, 'open').then(() => 'open')])
      .catch(() => 'error');
    assert.equal(end, 'error', `${protocols} was let in`);
  }
});

test('sends messages that decode by their schemas', async () => {
  for (const topic of peer.channels.keys()) peer.subscribe(topic);
  const expected = ['swarm/plan', 'swarm/scene', 'swarm/heartbeat', 'swarm/status', 'swarm/cell', ...Object.keys(OWN)];
  await peer.until(() => expected.every((topic) => peer.messages.some((m) => m.topic === topic)), `one of each of ${expected}`);
  const one = (topic) => peer.messages.find((m) => m.topic === topic).data;
  for (const topic of Object.keys(RAW).filter((name) => expected.includes(name))) {
    assert.equal(one(topic).schema_version, one('swarm/plan').schema_version, topic);
  }
  assert.ok(one('swarm/plan').nodes.length > 0);
  for (const { data } of peer.messages.filter((m) => m.topic === 'swarm/cell')) {
    assert.ok(data.states.length > 0 && data.states.every((state) => state.robot_id < scene.robots));
  }
});

test('shows every robot, inside the map', async () => {
  const [[left, bottom], [right, top]] = scene.bounds;
  const { data } = await peer.next('/robots', (m) => m.data.poses.length === scene.robots);
  assert.equal(data.frame_id, 'map');
  for (const { position, orientation } of data.poses) {
    assert.ok(position.x >= left && position.x <= right && position.y >= bottom && position.y <= top, JSON.stringify(position));
    // Half of a heading's sine and cosine, in doubles.
    assert.ok(Math.abs(Math.hypot(orientation.z, orientation.w) - 1) < 1e-12, JSON.stringify(orientation));
  }
  assert.ok(peer.messages.filter((m) => m.topic === '/robots').every((m) => m.data.poses.length <= scene.robots));
});

test('shows obstacles and mixture', async () => {
  const onPage = async () => {
    const { obstacles } = await pageScene();
    return ['polygon', 'circle'].map((kind) => obstacles.filter((o) => o[kind]).map((o) => o[kind]));
  };
  const here = () => {
    const [{ lines, cylinders }] = peer.messages.findLast((m) => m.topic === '/obstacles').data.entities;
    return [lines.map((line) => line.points.map(({ x, y }) => [x, y])),
      cylinders.map(({ pose, size }) => [pose.position.x, pose.position.y, size.x / 2])];
  };
  // They may change between one look and the other.
  for (let left = 50; left > 0 && !isDeepStrictEqual(here(), await onPage()); --left) await peer.next('/robots');
  assert.deepEqual(here(), await onPage());
  const { data } = await peer.next('/mixture', (m) => m.data.entities[0].cylinders.length > 0);
  for (const { size } of data.entities[0].cylinders) assert.ok(size.x >= size.y && size.y > 0, JSON.stringify(size));
});

test('its clock goes on', async () => {
  const from = peer.times.length;
  await peer.until(() => peer.times.length >= from + 5, 'time');
  peer.times.forEach((time, i) => assert.ok(i === 0 || time >= peer.times[i - 1]));
  assert.ok(peer.times.at(-1) > peer.times[from]);
});

test('who comes late gets the plan, which was published once', async () => {
  const late = await Peer.open(SERVER);
  late.subscribe('swarm/plan');
  const { data, timestamp } = await late.until(() => late.messages[0], 'plan');
  const known = await peer.until(() => peer.messages.find((m) => m.topic === 'swarm/plan' && m.timestamp === timestamp), 'plan');
  assert.deepEqual(data, known.data);
  await late.close();
});

test('unsubscribing stops messages', async () => {
  const other = await Peer.open(SERVER);
  const first = other.subscribe('/robots');
  for (let i = 0; i < 3; ++i) await other.next('/robots');
  other.client.unsubscribe(first);
  // When this is answered, what came before it has been done.
  await other.answerTo('done?');
  const [messages, times] = [other.messages.length, other.times.length];
  await other.until(() => other.times.length >= times + 10, 'time');
  assert.equal(other.messages.length, messages);
  const second = other.subscribe('/robots');
  const { id } = await other.next('/robots');
  assert.equal(id, second);
  await other.close();
});

const subscriptions = (...all) => JSON.stringify({ op: 'subscribe', subscriptions: all });
const GARBAGE = [
  '', '{', 'null', '[]', '"subscribe"', '{"op":7}', '{"op":"nothing"}', '['.repeat(60000), '\u0000\ufffd'.repeat(100),
  'x'.repeat(200000), '{"op":"subscribe"}', '{"op":"subscribe","subscriptions":{}}', subscriptions(7), subscriptions({ id: 1 }),
  subscriptions({ id: -1, channelId: 0 }), subscriptions({ id: 5, channelId: 1e99 }), subscriptions({ id: 5, channelId: 0.5 }),
  subscriptions({ id: 5, channelId: 4000000000 }), '{"op":"unsubscribe","subscriptionIds":[77]}',
  '{"op":"unsubscribe","subscriptionIds":"all"}', '{"op":"advertise","channels":[]}', '{"op":"getParameters","parameterNames":[]}',
  ...[[], [1], [1, 0, 0, 0, 0, 9], [255, 1, 2, 3], new Array(100000).fill(2)].map((bytes) => Uint8Array.from(bytes)),
];

test('answers garbage with a status and goes on', async () => {
  for (const frame of GARBAGE) {
    const other = await Peer.open(SERVER);
    other.subscribe('/robots');
    const { level, message } = await other.answerTo(frame);
    assert.ok(level >= 1 && message.length > 0, String(frame.slice(0, 60)));
    await other.next('/robots');
    await other.close();
  }
  await peer.next('/robots');
});

test('lets go of who sends nothing else, or no WebSocket at all', async () => {
  const other = await Peer.open(SERVER);
  const end = once(other.socket, 'close');
  for (let i = 0; i < 100; ++i) other.socket.send('{');
  const POLICY_VIOLATION = 1008;
  assert.equal((await end)[0], POLICY_VIOLATION);

  // Text that is no text may cost its connection, but no other.
  const third = await Peer.open(SERVER);
  third.socket.send(Uint8Array.from([0xff, 0xfe, 0xc0, 0x80]), { binary: false });
  const raw = connect(Number(port), hostname);
  raw.on('error', () => {});
  const gone = once(raw, 'close');
  raw.resume().end(Buffer.from(Array.from({ length: 5000 }, (_, i) => (i * 37) % 256)));
  await gone;
  await peer.next('/robots');
  third.socket.terminate();
});

// A server lets go of who is silent for 40 s: then nothing would be skipped any more, and this would go on for ever.
test('a client that does not read delays no other', { timeout: 60_000 }, async () => {
  const skipped = async () => {
    const text = await (await fetch(`${origin}/metrics`)).text();
    return Number(/^swarm_view_samples_skipped_total (\d+)$/m.exec(text)[1]);
  };
  const stuck = await Peer.open(SERVER);
  stuck.socket.onmessage = null;
  const before = await skipped();
  for (const topic of stuck.channels.keys()) if (topic !== 'swarm/plan') stuck.subscribe(topic);
  stuck.socket.pause();
  const plan = stuck.channels.get('swarm/plan').id;
  const begun = peer.messages.length;
  // Has the plan sent again and again, until the kernel takes no more for this client and its samples are skipped.
  while ((await skipped()) < before + 100) {
    assert.equal(stuck.socket.readyState, WebSocket.OPEN);
    for (let i = 0; i < 100; ++i) {
      stuck.socket.send(JSON.stringify({ op: 'subscribe', subscriptions: [{ id: 1000, channelId: plan }] }));
      stuck.socket.send('{"op":"unsubscribe","subscriptionIds":[1000]}');
      await new Promise((done) => setImmediate(done));
    }
  }
  for (let i = 0; i < 10; ++i) await peer.next('/robots');
  const stamps = peer.messages.slice(begun).filter((m) => m.topic === '/robots').map((m) => ns(m.data.timestamp));
  stamps.forEach((stamp, i) => assert.ok(i === 0 || stamp > stamps[i - 1]));
  stuck.socket.terminate();
});
