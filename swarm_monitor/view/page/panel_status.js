// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The line at the top: mission, phase and counts of robots.
import { byId, put } from './text.js';

export class Status {
  connection(text, kind) {
    put(byId('connection'), text);
    byId('connection').dataset.kind = kind;
  }

  scene(scene) {
    put(byId('name'), scene.name);
    document.title = `${scene.name} – Swarmflow`;
    put(byId('kind'), scene.live ? 'live' : 'recording');
    byId('kind').dataset.kind = scene.live ? 'live' : 'recording';
    byId('kind').hidden = false;
    byId('excess-entry').hidden = !(scene.plan_excess_m > 0);
    put(byId('excess'), `${(scene.plan_excess_m ?? 0).toFixed(2)} m`);
  }

  viewFrame(phase, counts, robots) {
    put(byId('phase'), phase);
    byId('phase').dataset.phase = phase;
    put(byId('received'), `${counts.received} / ${robots}`);
    for (const name of ['moving', 'arrived', 'lost']) put(byId(name), String(counts[name]));
    byId('lost').classList.toggle('bad', counts.lost > 0);
  }

  rate(viewFrames, frames) {
    put(byId('rate'), `${viewFrames}/s`);
    byId('rate').title = `${viewFrames} frames received and ${frames} drawn in the last second`;
  }
}
