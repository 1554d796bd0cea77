// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Puts the page together: frames in, map and panels out.
import { Camera } from './camera.js';
import { listenToPointers } from './gestures.js';
import { listenToKeys } from './keys.js';
import { Link } from './link.js';
import { SwarmMap } from './map.js';
import { Motion } from './motion.js';
import { Charts } from './panel_charts.js';
import { Control } from './panel_control.js';
import { Events } from './panel_events.js';
import { Legend } from './panel_legend.js';
import { RobotPanel } from './panel_robot.js';
import { Status } from './panel_status.js';
import { Timeline } from './panel_timeline.js';
import { countRobots, decode, RECEIVED, LOST, nearestRobot, robotOf } from './view_frame.js';
import { Player } from './player.js';
import { Scenes, toLocal } from './scenes.js';
import { byId, put } from './text.js';
import { readTheme } from './theme.js';

const ASK_MS = 32;         // at most about 30 frames a second
const ASK_STILL_MS = 100;  // while a live swarm has nothing new
const PANELS_MS = 150;
const GRASP_PX = 14;

const canvas = byId('canvas');
const stillness = matchMedia('(prefers-reduced-motion: reduce)');
const narrow = matchMedia('(max-width: 860px)');

const camera = new Camera();
const player = new Player();
const motion = new Motion();
const scenes = new Scenes();
const status = new Status();
const legend = new Legend();
const robotPanel = new RobotPanel();
const events = new Events(seek);
const charts = new Charts(seek);
const timeline = new Timeline(player, () => { dirty = true; });

let scene = null;     // the one shown
let counts = null;
let selected = null;  // ids
let hovered = null;
let pointer = null;   // CSS px on the canvas
let dirty = true;
let panelsDirty = true;
let asked = { key: '', at_ms: 0, sought: false, still: false };
const measured = { framesDrawn: 0, viewFramesReceived: 0, fps: 0, last: { at_ms: 0, frames: 0, viewFrames: 0 } };

const map = makeMap();
const link = new Link({ open: opened, message: received, viewFrame: receivedViewFrame, status: (...s) => status.connection(...s) });
const control = new Control((order) => link.send(order), (tool) => {
  canvas.classList.toggle('aiming', tool !== null);
  byId('crosshair').hidden = tool === null;
});

function notice(text) {
  byId('notice').hidden = text === '';
  put(byId('notice'), text);
}

function makeMap() {
  try {
    const made = new SwarmMap(canvas, camera);
    made.setTheme(readTheme());
    canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      notice('The browser took the graphics away. The map comes back when it gives them back.');
    });
    canvas.addEventListener('webglcontextrestored', () => {
      made.build();
      notice('');
      dirty = true;
    });
    return made;
  } catch (error) {
    notice('This browser does not offer WebGL2, so there is no map. Charts, events and figures work.');
    console.warn(error);
    return null;
  }
}

// ---- from the server

function opened() {
  scenes.clear();
  events.clear();
  charts.clear();
  asked.key = '';
  sentFocus = null;  // a new connection knows of none
  refocus();
}

function received(message) {
  switch (message.op) {
    case 'scene':
      scenes.add(toLocal(message));
      player.setRange(message, stillness.matches);
      status.scene(message);
      control.allow(message);
      charts.refresh(player.live ? null : [player.begin, player.end]);
      timeline.marks(events.all);
      chooseScene();
      break;
    case 'events':
      events.add(message.events, player.live);
      timeline.marks(events.all);
      break;
    case 'series':
      charts.add(message);
      charts.refresh();
      break;
    case 'done':
    case 'refused':
      control.answer(`${message.action.replace('_', ' ')}: ${message.text || message.op}`, message.op);
      break;
  }
  panelsDirty = true;
}

function chooseScene() {
  const wanted = player.live ? scenes.newest() : scenes.at(motion.now?.t ?? player.t);
  if (wanted === scene || wanted === null) return;
  scene = wanted;
  map?.setScene(scene);
  legend.labels(scene);
  moved();
}

function receivedViewFrame(buffer) {
  const viewFrame = decode(buffer);
  measured.viewFramesReceived += 1;
  const { fresh, jumped } = motion.add(viewFrame, asked.sought, performance.now());
  asked.still = !fresh;
  map?.setViewFrame(viewFrame, fresh, jumped);
  chooseScene();
  if (fresh) counts = countRobots(viewFrame, scene?.goal.length ?? 0);
  robotPanel.observe(robotOf(viewFrame, focusId()), viewFrame.t);
  rehover();
  dirty = panelsDirty = true;
}

function askIfDue(now_ms) {
  if (!scene || !link.idle || now_ms - asked.at_ms < (asked.still && player.live ? ASK_STILL_MS : ASK_MS)) return;
  const key = `${player.t}/${sentFocus}`;
  if (!player.live && key === asked.key) return;
  asked = { key, at_ms: now_ms, sought: player.sought, still: asked.still };
  player.sought = false;
  link.ask(player.live ? null : player.t);
}

// ---- the robot looked at

let sentFocus = null;

function focusId() {
  return selected ?? hovered;
}

function refocus() {
  dirty = panelsDirty = true;
  if (focusId() !== sentFocus && link?.send({ op: 'focus', robot: focusId() })) sentFocus = focusId();
}

function robotAt(x_px, y_px) {
  if (!motion.now || !scene) return null;
  return nearestRobot(motion.now, ...camera.toWorld(x_px, y_px), Math.max(GRASP_PX / camera.scale, scene.radius_m));
}

function rehover() {
  const found = pointer && control.tool === null ? robotAt(...pointer) : null;
  if (found === hovered) return;
  hovered = found;
  canvas.classList.toggle('over', hovered !== null);
  refocus();
}

function select(id) {
  selected = id;
  const robot = robotOf(motion.now, id);
  put(byId('announcement'), robot ? `Robot ${id} chosen, ${robot.mode}` : 'No robot chosen');
  refocus();
}

function selectNext(step) {
  const viewFrame = motion.now;
  if (!viewFrame || viewFrame.n === 0) return;
  let id = selected ?? (step > 0 ? -1 : viewFrame.n);
  for (let tries = 0; tries < viewFrame.n; ++tries) {
    id = (id + step + viewFrame.n) % viewFrame.n;
    if (viewFrame.info[16 * id + 14] & (RECEIVED | LOST)) break;
  }
  select(id);
  const robot = robotOf(viewFrame, id);
  const [x, y] = camera.toScreen(robot.x, robot.y);
  if (x < 0 || y < 0 || x > camera.width || y > camera.height) {
    camera.pan(camera.width / 2 - x, camera.height / 2 - y);
    moved();
  }
}

// ---- what the user does

function seek(t) {
  player.seek(t);
  dirty = panelsDirty = true;
}

function moved() {
  legend.moved(camera);
  dirty = true;
}

/** Coordinates of the mission; those of the map begin at the scene's origin. */
function inWorld(x, y) {
  const [x0, y0] = scene?.origin ?? [0, 0];
  return [x + x0, y + y0];
}

function robotInWorld(robot) {
  if (robot === null) return null;
  const [x, y] = inWorld(robot.x, robot.y);
  return { ...robot, x, y };
}

function tapped(x_px, y_px) {
  if (control.tool !== null) control.useAt(...inWorld(...camera.toWorld(x_px, y_px)));
  else select(robotAt(x_px, y_px));
}

const act = {
  toggle: () => { player.toggle(); panelsDirty = true; },
  seekBy: (s) => seek(player.t + s),
  pan: (dx, dy) => { camera.pan(dx, dy); moved(); },
  zoom: (factor) => { camera.zoom(factor); moved(); },
  fit: () => { camera.fit(); moved(); },
  choose: selectNext,
  escape: () => (control.tool !== null ? control.setTool(null) : select(null)),
  enter: () => { if (control.tool !== null) tapped(camera.width / 2, camera.height / 2); },
  help: () => byId('help').showModal(),
  live: () => player.live,
};

listenToPointers(canvas, camera, {
  moved,
  hover: (x, y) => { pointer = x === null ? null : [x, y]; rehover(); },
  tap: tapped,
});
listenToKeys(canvas, byId('slider'), act);
byId('zoom-in').addEventListener('click', () => act.zoom(1.4));
byId('zoom-out').addEventListener('click', () => act.zoom(1 / 1.4));
byId('zoom-fit').addEventListener('click', act.fit);
byId('help-open').addEventListener('click', act.help);
byId('help-close').addEventListener('click', () => byId('help').close());
byId('robot-previous').addEventListener('click', () => selectNext(-1));
byId('robot-next').addEventListener('click', () => selectNext(1));

for (const name of ['trails', 'plan', 'mixture', 'cells', 'modes']) {
  const box = byId(`show-${name}`);
  const apply = () => {
    if (!map) return;
    if (name === 'modes') map.byMode = box.checked;
    else map.layers[name] = box.checked;
    dirty = panelsDirty = true;
  };
  box.addEventListener('change', apply);
  apply();
}

function fold() {
  byId('charts').open = !narrow.matches;
}
narrow.addEventListener('change', fold);
fold();

matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
  map?.setTheme(readTheme());
  charts.restyle();
  dirty = true;
});

new ResizeObserver(() => {
  if (map) map.resize();
  else camera.resize(canvas.clientWidth, canvas.clientHeight);
  moved();
  draw(performance.now());  // at once: a resized canvas is empty
}).observe(canvas);

// ---- every frame

function draw(now_ms) {
  const mix = motion.mix(now_ms);
  dirty = mix < 1;
  const robot = robotOf(motion.now, focusId());
  let chosen = null;
  if (robot && (robot.received || robot.lost)) {
    const [x, y] = motion.position(robot, mix);
    chosen = { x, y, held: selected !== null, estimates: motion.now.focus === robot.id ? motion.now.estimates : [] };
  }
  map?.draw(mix, chosen);
  measured.framesDrawn += 1;
}

function showPanels() {
  panelsDirty = false;
  const t = motion.now?.t ?? player.t;
  timeline.show(t);
  events.show(t);
  charts.mark(t);
  if (!motion.now || !scene || !counts) return;
  status.viewFrame(motion.now.phase, counts, scene.robots);
  legend.update(scene, counts, byId('show-modes').checked);
  robotPanel.show(robotInWorld(robotOf(motion.now, focusId())), selected !== null, motion.now);
}

function measure(now_ms) {
  const { last } = measured;
  const elapsed_s = (now_ms - last.at_ms) / 1000;
  if (elapsed_s < 1) return;
  measured.fps = (measured.framesDrawn - last.frames) / elapsed_s;
  status.rate(Math.round((measured.viewFramesReceived - last.viewFrames) / elapsed_s), Math.round(measured.fps));
  measured.last = { at_ms: now_ms, frames: measured.framesDrawn, viewFrames: measured.viewFramesReceived };
}

let lastFrame_ms = performance.now();
let lastPanels_ms = 0;
let shown = '';

function frame(now_ms) {
  requestAnimationFrame(frame);
  const elapsed_ms = now_ms - lastFrame_ms;
  lastFrame_ms = now_ms;
  motion.frame(elapsed_ms);
  player.advance(Math.min(elapsed_ms, 250) / 1000);
  askIfDue(now_ms);
  if (dirty) draw(now_ms);
  const state = `${player.t}/${player.playing}`;
  if ((panelsDirty || state !== shown) && now_ms - lastPanels_ms > PANELS_MS) {
    lastPanels_ms = now_ms;
    shown = state;
    showPanels();
  }
  measure(now_ms);
}
requestAnimationFrame(frame);

// ---- for tests and for the curious; nothing here changes the swarm

window.swarmflow = Object.freeze({
  state: () => ({
    connected: link.connected, t: motion.now?.t ?? null, robots: motion.now?.n ?? 0, phase: motion.now?.phase ?? null,
    selected, playing: player.playing, framesDrawn: measured.framesDrawn,
    viewFramesReceived: measured.viewFramesReceived, fps: measured.fps,
  }),
  robot: (id) => robotInWorld(robotOf(motion.now, id)),
  toScreen: (x, y) => {
    const [x0, y0] = inWorld(0, 0);
    return camera.toScreen(x - x0, y - y0);
  },
  seek,
});
