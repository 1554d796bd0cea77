// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Numbers as short texts, and elements that hold text only.

/** 61.34 -> "1:01.3" */
export function clock(t) {
  if (!Number.isFinite(t)) return '–';
  const tenths = Math.round(Math.abs(t) * 10);
  const minutes = Math.floor(tenths / 600);
  const seconds = ((tenths % 600) / 10).toFixed(1).padStart(4, '0');
  return `${t < 0 && tenths > 0 ? '−' : ''}${minutes}:${seconds}`;
}

/** Sets the text only when it changed, which spares layout. */
export function put(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** make('li', {className: 'event'}, 'text', child): received strings become text, never HTML. */
export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(properties)) {
    if (key.includes('-')) element.setAttribute(key, value);
    else element[key] = value;
  }
  element.append(...children);
  return element;
}

export const byId = (id) => document.getElementById(id);
