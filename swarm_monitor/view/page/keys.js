// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The whole page by keyboard. Keys that a focused control needs for itself stay with it.

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const PAN_PX = 60;

/** `on`: {toggle(), seekBy(s), pan(dx, dy), zoom(factor), fit(), choose(step), escape(), enter(), help(), live()}. */
export function listenToKeys(canvas, slider, on) {
  document.addEventListener('keydown', (event) => {
    const { target, key } = event;
    if (event.altKey || event.metaKey || document.querySelector('dialog[open]')) return;
    if (target.matches('input:not([type=range]):not([type=checkbox]), select, textarea')) return;
    if (handle(target, key, event)) event.preventDefault();
  });

  function handle(target, key, event) {
    if (key in ARROWS) return arrow(target, ARROWS[key], event);
    if (event.ctrlKey) return false;
    const pressable = target.matches('button, summary, input[type=checkbox]');
    switch (key) {
      case ' ': return !pressable && (on.toggle(), true);
      case 'Enter': return target === canvas && (on.enter(), true);
      case '+': case '=': on.zoom(1.3); return true;
      case '-': on.zoom(1 / 1.3); return true;
      case '0': on.fit(); return true;
      case '[': on.choose(-1); return true;
      case ']': on.choose(1); return true;
      case 'Escape': on.escape(); return true;
      case '?': on.help(); return true;
      default: return false;
    }
  }

  function arrow(target, [dx, dy], event) {
    if (target === canvas && (event.ctrlKey || on.live())) {
      on.pan(-dx * PAN_PX, dy * PAN_PX);
      return true;
    }
    if (event.ctrlKey || (target !== canvas && target !== slider)) return false;
    on.seekBy((dx || dy) * (event.shiftKey ? 10 : 1));
    return true;
  }
}
