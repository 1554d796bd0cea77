// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The map's colours come from the style sheet, so light and dark are decided in one place.

function rgb(style, name) {
  const hex = style.getPropertyValue(name).trim();
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
}

export function readTheme() {
  const style = getComputedStyle(document.documentElement);
  const goals = ['0', '1', '2', '3', '4', '5', '6', '7', 'n'].map((i) => rgb(style, `--goal-${i}`));
  const modes = ['waiting', 'moving', 'holding', 'arrived', 'stopped'].map((name) => rgb(style, `--mode-${name}`));
  const names = ['outside', 'ground', 'grid', 'cell', 'rim', 'obstacle', 'obstacle-rim', 'leg', 'start', 'mixture',
    'lost', 'chosen'];
  const theme = { goals, modes, goalsFlat: goals.flat(), modesFlat: modes.flat() };
  for (const name of names) theme[name] = rgb(style, `--map-${name}`);
  return theme;
}

/** The CSS variable of a goal; null: of none. */
export function goalVariable(goal) {
  return goal === null ? 'var(--goal-n)' : `var(--goal-${goal % 8})`;
}
