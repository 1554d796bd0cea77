// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0

// MCAP files by the format's own library: as a stream, which needs no index, and by the index.
import { McapIndexedReader, McapStreamReader } from '@mcap/core';
import { loadDecompressHandlers } from '@mcap/support';

const decompressHandlers = await loadDecompressHandlers();

/**
 * What a stream of these bytes gives until they end, checksums validated. Messages come with their channel, schema and
 * the number of their chunk; `done`: the file's end was seen.
 */
export function readStream(bytes) {
  const reader = new McapStreamReader({ includeChunks: true, validateCrcs: true, decompressHandlers });
  reader.append(bytes);
  const found = { messages: [], chunks: [], attachments: [], channels: new Map(), schemas: new Map() };
  for (let record = reader.nextRecord(); record; record = reader.nextRecord()) {
    if (record.type === 'Schema') found.schemas.set(record.id, record);
    if (record.type === 'Channel') found.channels.set(record.id, record);
    if (record.type === 'Attachment') found.attachments.push(record);
    if (record.type === 'Chunk') found.chunks.push(record);
    if (record.type === 'Message') {
      const channel = found.channels.get(record.channelId);
      found.messages.push({ ...record, channel, schema: found.schemas.get(channel.schemaId), chunk: found.chunks.length - 1 });
    }
  }
  return { ...found, done: reader.done(), bytesLeft: reader.bytesRemaining() };
}

export function openIndexed(bytes) {
  const readable = {
    size: async () => BigInt(bytes.byteLength),
    read: async (offset, size) => new Uint8Array(bytes.buffer, bytes.byteOffset + Number(offset), Number(size)),
  };
  return McapIndexedReader.Initialize({ readable, decompressHandlers });
}
