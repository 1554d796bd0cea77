// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0

// The live view in a real browser, software-rendered, against the server at SWARM_VIEW_URL (a live run or a recording;
// with #token=... also the control panel). SWARM_MIN_FPS: asserts a frame rate, which is only printed otherwise.
// SWARM_SHOTS: a folder for screenshots. CHROMIUM: the browser, if not Debian's.
import assert from 'node:assert/strict';
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import puppeteer from 'puppeteer-core';

const URL_OF_VIEW = process.env.SWARM_VIEW_URL;
assert.ok(URL_OF_VIEW, 'SWARM_VIEW_URL: where the view is served');
const SHOTS = process.env.SWARM_SHOTS;
const TIMEOUT_MS = 180000;  // against hanging for ever; nothing is measured by it

let browser, page, live;
const complaints = [];

async function open({ scheme = 'light', motion = 'no-preference', width = 1280, height = 800, prepare } = {}) {
  const opened = await browser.newPage();
  opened.setDefaultTimeout(TIMEOUT_MS);
  opened.on('console', (message) => {
    if (message.type() === 'error') complaints.push(message.text());
  });
  opened.on('pageerror', (error) => complaints.push(error.message));
  await opened.setViewport({ width, height });
  await opened.emulateMediaFeatures([
    { name: 'prefers-color-scheme', value: scheme }, { name: 'prefers-reduced-motion', value: motion },
  ]);
  if (prepare) await opened.evaluateOnNewDocument(prepare);
  await opened.goto(URL_OF_VIEW, { timeout: TIMEOUT_MS });
  await opened.waitForFunction(() => window.swarmflow?.state().robots > 0, { timeout: TIMEOUT_MS });
  // The panels follow the picture a little later.
  await opened.waitForFunction(() => document.getElementById('received').textContent !== '–', { timeout: TIMEOUT_MS });
  return opened;
}

const state = (of = page) => of.evaluate(() => window.swarmflow.state());
const text = (id, of = page) => of.$eval(`#${id}`, (element) => element.textContent);
const until = (condition, ...args) => page.waitForFunction(condition, {}, ...args);

async function setPlaying(wanted) {
  if ((await state()).playing !== wanted) await page.click('#play');
}

/** Seeks and waits for that picture. */
async function seek(t) {
  await page.evaluate((to) => window.swarmflow.seek(to), t);
  await until((to) => Math.abs(window.swarmflow.state().t - to) < 0.2, t);
}

before(async () => {
  browser = await puppeteer.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', headless: true, protocolTimeout: 4 * TIMEOUT_MS,
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  });
  page = await open();
  live = (await text('kind')) === 'live';
});

after(() => browser?.close());

test('loads and connects', async () => {
  assert.equal(await text('connection'), 'connected');
  assert.ok((await page.title()).endsWith('Swarmflow'));
  assert.equal(await page.$eval('#notice', (notice) => notice.hidden), true);
});

test('shows the number of robots', async () => {
  const { robots } = await state();
  if (live) {
    assert.match(await text('received'), new RegExp(`^\\d+ / ${robots}$`));
    return;
  }
  // The panel follows a moment after the picture: both are looked at together.
  await until((n) => {
    let received = 0;
    for (let id = 0; id < n; ++id) received += window.swarmflow.robot(id).received ? 1 : 0;
    return document.getElementById('received').textContent === `${received} / ${n}`;
  }, robots);
});

test('measures frames', async () => {
  if (!live) {
    await setPlaying(false);
    await seek(0);
    await page.select('#rate-choice', '1');
    await setPlaying(true);
  }
  const first = await state();
  const began = performance.now();
  await new Promise((done) => setTimeout(done, 3000));
  const last = await state();
  const seconds = (performance.now() - began) / 1000;
  const fps = (last.framesDrawn - first.framesDrawn) / seconds;
  const pictures = (last.viewFramesReceived - first.viewFramesReceived) / seconds;
  console.log(JSON.stringify({ robots: last.robots, fps: Number(fps.toFixed(1)), pictures_per_s: Number(pictures.toFixed(1)) }));
  assert.ok(last.framesDrawn > first.framesDrawn);
  if (process.env.SWARM_MIN_FPS) assert.ok(fps >= Number(process.env.SWARM_MIN_FPS), `${fps} frames/s`);
});

/** Pixels of the map as shown, at points in CSS pixels of the canvas. */
async function pixels(points) {
  const box = await (await page.$('#canvas')).boundingBox();
  const shot = await page.screenshot({ clip: { ...box }, encoding: 'base64' });
  return page.evaluate(async (data, at) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    return at.map(([x, y]) => [...context.getImageData(Math.floor(x), Math.floor(y), 1, 1).data.slice(0, 3)]);
  }, shot, points);
}

test('draws robots where they are, in the colours of their goals', async (t) => {
  if (live) return t.skip('robots of a live run have moved on by the time of the screenshot');
  await setPlaying(false);
  await seek(5);
  await page.click('.layers summary');
  for (const layer of ['trails', 'mixture', 'plan']) await page.click(`#show-${layer}`);
  await page.click('.layers summary');
  // Robots that nothing covers: clear of each other and of what lies upon the map.
  const robots = await page.evaluate(() => {
    const all = [];
    for (let id = 0; id < window.swarmflow.state().robots; ++id) {
      const robot = window.swarmflow.robot(id);
      const [x, y] = window.swarmflow.toScreen(robot.x, robot.y);
      if (robot.received) all.push({ ...robot, sx: x, sy: y });
    }
    const box = document.getElementById('canvas').getBoundingClientRect();
    return all.filter((a) => !a.lost && !a.arrived &&
      document.elementFromPoint(box.left + a.sx, box.top + a.sy)?.id === 'canvas' &&
      all.every((b) => b === a || Math.hypot(a.sx - b.sx, a.sy - b.sy) > 20)).slice(0, 50);
  });
  assert.ok(robots.length > 0, 'no robot stands alone');
  const goals = await page.evaluate(() => ['0', '1', '2', '3', '4', '5', '6', '7', 'n'].map((i) => {
    const hex = getComputedStyle(document.documentElement).getPropertyValue(`--goal-${i}`).trim();
    return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
  }));
  // Behind the middle, away from the heading's tick: 1.6 px is within the smallest disc, which has 3.
  const seen = await pixels(robots.map((r) => [r.sx - 1.6 * Math.cos(r.heading), r.sy + 1.6 * Math.sin(r.heading)]));
  robots.forEach((robot, i) => {
    const expected = goals[robot.goal === null ? 8 : robot.goal % 8];
    const off = Math.max(...expected.map((value, k) => Math.abs(value - seen[i][k])));
    // Blending and the rounding of colours: a few of 255; another goal's colour is 40 or more off.
    assert.ok(off <= 16, `robot ${robot.id}: ${seen[i]} instead of ${expected}`);
  });
  const [outside] = await pixels([[2, 2]]);
  assert.ok(goals.every((goal) => goal.some((value, k) => Math.abs(value - outside[k]) > 16)));
});

test('plays, pauses and seeks by button, keyboard and slider', async (t) => {
  if (live) return t.skip('a live run has no clock to turn');
  await setPlaying(false);
  await seek(5);
  await page.focus('#canvas');
  await page.keyboard.press('ArrowRight');
  await until(() => Math.abs(window.swarmflow.state().t - 6) < 0.2);
  await page.keyboard.down('Shift');
  await page.keyboard.press('ArrowRight');
  await page.keyboard.up('Shift');
  await until(() => Math.abs(window.swarmflow.state().t - 16) < 0.2);
  await page.focus('#slider');
  await page.keyboard.press('ArrowLeft');
  await until(() => Math.abs(window.swarmflow.state().t - 15) < 0.2);

  await page.focus('#canvas');
  await page.keyboard.press('Space');
  assert.equal((await state()).playing, true);
  await until(() => window.swarmflow.state().t > 15.3);
  await until(() => document.getElementById('play').getAttribute('aria-label') === 'Pause');
  await page.keyboard.press('Space');
  assert.equal((await state()).playing, false);

  const box = await (await page.$('#slider')).boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  const [begin, end] = await page.$eval('#slider', (slider) => [Number(slider.min), Number(slider.max)]);
  await until((middle, span) => Math.abs(window.swarmflow.state().t - middle) < 0.03 * span, (begin + end) / 2, end - begin);
});

test('chooses robots by keyboard and by pointer', async () => {
  await page.focus('#canvas');
  await page.keyboard.press(']');
  const { selected } = await state();
  assert.notEqual(selected, null);
  await until((id) => document.getElementById('robot-title').textContent === `Robot ${id}`, selected);
  await page.keyboard.press('[');
  assert.notEqual((await state()).selected, null);
  await page.keyboard.press('Escape');
  assert.equal((await state()).selected, null);

  const box = await (await page.$('#canvas')).boundingBox();
  const place = () => page.evaluate(() => {
    const canvas = document.getElementById('canvas'), { left, top } = canvas.getBoundingClientRect();
    for (let id = 0; id < window.swarmflow.state().robots; ++id) {
      const robot = window.swarmflow.robot(id);
      const [x, y] = window.swarmflow.toScreen(robot.x, robot.y);
      if (robot.received && document.elementFromPoint(left + x, top + y) === canvas) return [x, y];
    }
    return null;
  });
  // A robot of a live run may have moved on before the press: then once more.
  for (let tries = 0; tries < (live ? 100 : 1) && (await state()).selected === null; ++tries) {
    const [x, y] = await place();
    await page.mouse.click(box.x + x, box.y + y);
  }
  assert.notEqual((await state()).selected, null);
  await page.keyboard.press('Escape');
});

test('zooms, pans and fits by keyboard and wheel', async () => {
  const shift = () => page.evaluate(() => {
    const [[x0, y0], [x1]] = [window.swarmflow.toScreen(0, 0), window.swarmflow.toScreen(1, 0)];
    return { x0, y0, metre: x1 - x0 };
  });
  await page.focus('#canvas');
  await page.keyboard.press('0');
  const fitted = await shift();
  await page.keyboard.press('+');
  assert.ok((await shift()).metre > 1.2 * fitted.metre);
  await page.keyboard.down('Control');
  await page.keyboard.press('ArrowRight');
  await page.keyboard.up('Control');
  await page.keyboard.press('0');
  assert.deepEqual(await shift(), fitted);
  const box = await (await page.$('#canvas')).boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.wheel({ deltaY: -200 });
  await until((metre) => window.swarmflow.toScreen(1, 0)[0] - window.swarmflow.toScreen(0, 0)[0] > metre, fitted.metre);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + 80, box.y + box.height / 2, { steps: 4 });
  await page.mouse.up();
  assert.equal((await state()).selected, null, 'a drag chooses nothing');
  await page.click('#zoom-fit');
  assert.deepEqual(await shift(), fitted);
});

test('shows its keys', async () => {
  await page.focus('#canvas');
  await page.keyboard.press('?');
  assert.equal(await page.$eval('#help', (help) => help.open), true);
  await page.keyboard.press('Escape');
  assert.equal(await page.$eval('#help', (help) => help.open), false);
});

test('shows the control panel only to who may use it', async (t) => {
  const shown = await page.$eval('#control', (panel) => !panel.hidden);
  if (!new URL(URL_OF_VIEW).hash.includes('token=')) {
    assert.equal(shown, false);
    return;
  }
  if (!shown) return t.skip('the server takes no commands');
  await page.click('#do-pause');
  await until(() => document.getElementById('answer').dataset.kind === 'done');
  await page.click('#do-resume');
  await until(() => document.getElementById('answer').textContent.startsWith('resume') &&
    document.getElementById('answer').dataset.kind === 'done');
  await page.click('#do-stop');
  assert.match(await text('do-stop'), /again/);
  await until(() => document.getElementById('do-stop').textContent === 'Stop');
  assert.notEqual((await state()).phase, 'stopped');
});

test('every control has a name', async () => {
  const nameless = await page.$$eval('button, input, select, summary, #canvas', (all) => all.filter((element) =>
    !element.closest('.plot') && !element.getAttribute('aria-label') && !element.textContent.trim() &&
    !element.labels?.[0]?.textContent.trim())
    .map((element) => element.id));
  assert.deepEqual(nameless, []);
});

test('fits a phone', async () => {
  const phone = await open({ width: 360, height: 740 });
  const [wide, visible] = await phone.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
  assert.equal(wide, visible);
  assert.equal(visible, 360);
  assert.equal(await phone.$eval('#charts', (charts) => charts.open), false);
  if (SHOTS) await phone.screenshot({ path: join(SHOTS, 'phone.png'), fullPage: true });
  await phone.close();
});

test('does not start to play where motion is not wanted', async (t) => {
  if (live) return t.skip('a live run has no clock to turn');
  const still = await open({ motion: 'reduce' });
  assert.equal((await state(still)).playing, false);
  await still.close();
});

test('connects again by itself', async () => {
  const other = await open({
    prepare: () => {
      const Original = window.WebSocket;
      window.WebSocket = class extends Original {
        constructor(...args) {
          super(...args);
          window.lastSocket = this;
        }
      };
    },
  });
  await other.evaluate(() => window.lastSocket.close());
  await other.waitForFunction(() => document.getElementById('connection').textContent.includes('trying again'));
  await other.waitForFunction(() => window.swarmflow.state().connected);
  const { viewFramesReceived } = await state(other);
  if (!live) await other.evaluate(() => window.swarmflow.seek(1));
  await other.waitForFunction((before) => window.swarmflow.state().viewFramesReceived > before, {}, viewFramesReceived);
  await other.close();
});

test('reports that WebGL2 is missing', async () => {
  const bare = await open({ prepare: () => { HTMLCanvasElement.prototype.getContext = ((original) => function get(kind, ...rest) {
    return kind === 'webgl2' ? null : original.call(this, kind, ...rest);
  })(HTMLCanvasElement.prototype.getContext); } });
  assert.match(await text('notice', bare), /WebGL2/);
  assert.equal(await bare.$eval('#notice', (notice) => notice.hidden), false);
  await bare.close();
});

test('light and dark', async () => {
  const grounds = [];
  if (SHOTS) mkdirSync(SHOTS, { recursive: true });
  for (const scheme of ['light', 'dark']) {
    const shown = await open({ scheme });
    grounds.push(await shown.evaluate(() => getComputedStyle(document.body).backgroundColor));
    if (!live) await shown.evaluate(() => window.swarmflow.seek(20));
    await shown.waitForFunction((n) => window.swarmflow.state().framesDrawn > n, {}, (await state(shown)).framesDrawn + 3);
    if (SHOTS) await shown.screenshot({ path: join(SHOTS, `${scheme}.png`) });
    await shown.close();
  }
  assert.notEqual(grounds[0], grounds[1]);
});

test('nothing was complained about', () => {
  assert.deepEqual(complaints, []);
});
