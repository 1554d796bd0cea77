// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Mouse, pen and fingers on the map: drag pans, wheel and pinch zoom, a tap is a tap.

const TAP_PX = 4;

/** `on`: {moved(), hover(x, y) or hover(null), tap(x, y)}, in CSS pixels of the canvas. */
export function listenToPointers(canvas, camera, on) {
  const down = new Map();  // pointer id -> [x, y]
  let travelled = 0;

  const at = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const spread = () => {
    const [[ax, ay], [bx, by]] = [...down.values()];
    return { x: (ax + bx) / 2, y: (ay + by) / 2, far: Math.max(Math.hypot(ax - bx, ay - by), 1) };
  };

  canvas.addEventListener('pointerdown', (event) => {
    if (event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    if (down.size === 0) travelled = 0;
    if (down.size < 2) down.set(event.pointerId, at(event));
  });

  canvas.addEventListener('pointermove', (event) => {
    const now = at(event);
    const before = down.get(event.pointerId);
    if (!before) {
      if (event.pointerType !== 'touch') on.hover(...now);
      return;
    }
    travelled += Math.hypot(now[0] - before[0], now[1] - before[1]);
    if (down.size === 2) {
      const old = spread();
      down.set(event.pointerId, now);
      const fresh = spread();
      camera.pan(fresh.x - old.x, fresh.y - old.y);
      camera.zoom(fresh.far / old.far, fresh.x, fresh.y);
      on.moved();
    } else if (travelled > TAP_PX) {
      down.set(event.pointerId, now);
      camera.pan(now[0] - before[0], now[1] - before[1]);
      on.moved();
    }
  });

  const up = (event) => {
    if (!down.delete(event.pointerId)) return;
    if (event.type === 'pointerup' && down.size === 0 && travelled <= TAP_PX) on.tap(...at(event));
  };
  canvas.addEventListener('pointerup', up);
  canvas.addEventListener('pointercancel', up);
  canvas.addEventListener('pointerleave', () => on.hover(null));

  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    const px = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 32 * event.deltaY : event.deltaY;
    camera.zoom(Math.exp(-0.0016 * px), ...at(event));
    on.moved();
  }, { passive: false });
}
