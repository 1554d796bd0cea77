// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0

// CDR decoded by nothing but the IDL that comes with it, by a library that knows no Swarmflow.
import omgidl from '@foxglove/omgidl-parser';
import serialization from '@foxglove/omgidl-serialization';

const definitions = new Map();
const readers = new Map();

function definitionsOf(idl) {
  if (!definitions.has(idl)) definitions.set(idl, omgidl.parseIDL(idl));
  return definitions.get(idl);
}

/** A decoder for messages of the struct `name` of this IDL. */
export function readerOf(name, idl) {
  const key = `${name}\n${idl}`;
  if (!readers.has(key)) readers.set(key, new serialization.MessageReader(name, definitionsOf(idl)));
  return readers.get(key);
}

/** How many bytes a message has by its IDL when it is decoded and encoded again, in the same kind of CDR. */
export function sizeByIdl(name, idl, bytes) {
  const writer = new serialization.MessageWriter(name, definitionsOf(idl), { kind: bytes[1] });
  return writer.writeMessage(readerOf(name, idl).readMessage(bytes)).length;
}

const isList = (value) => Array.isArray(value) || (ArrayBuffer.isView(value) && !(value instanceof DataView));

function same(expected, read) {
  if (typeof read === 'bigint') return expected === String(read);
  // JSON has no value for numbers that are not finite.
  if (typeof read === 'number' && !Number.isFinite(read)) return expected === null;
  return Object.is(expected, read);
}

/** Where JSON and a decoded message differ: { path, expected, read } for every field. */
export function* differences(expected, read, path = '') {
  const nested = read !== null && typeof read === 'object';
  if (!nested || expected === null || typeof expected !== 'object' || isList(expected) !== isList(read)) {
    if (!same(expected, read)) yield { path, expected, read };
    return;
  }
  if (isList(read)) {
    if (expected.length !== read.length) yield { path: `${path}.length`, expected: expected.length, read: read.length };
    for (let i = 0; i < Math.min(expected.length, read.length); ++i) yield* differences(expected[i], read[i], `${path}[${i}]`);
    return;
  }
  for (const name of new Set([...Object.keys(expected), ...Object.keys(read)])) {
    yield* differences(expected[name], read[name], path ? `${path}.${name}` : name);
  }
}

export const shown = (value) =>
  JSON.stringify(value, (_, part) => (typeof part === 'bigint' ? String(part) : part)) ?? String(value);
