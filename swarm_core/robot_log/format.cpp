// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/robot_log/format.hpp"

#include <algorithm>

#include <zlib.h>
#include <zstd.h>

#include "swarm_core/base/assert.hpp"

namespace swarm::mcap {

void ChunkContent::clear() {
  records.clear();
  messages = 0;
}

// Keeps the earliest and latest log time: messages of several robots may arrive out of order.
void ChunkContent::add(const Message& message) {
  begin_ns = messages == 0 ? message.log_time_ns : std::min(begin_ns, message.log_time_ns);
  end_ns = messages == 0 ? message.log_time_ns : std::max(end_ns, message.log_time_ns);
  ++messages;
  append_message(records, message);
}

// CRC-32 as zlib computes it, which the MCAP specification demands.
std::uint32_t crc_of(std::span<const unsigned char> bytes) {
  return static_cast<std::uint32_t>(::crc32_z(0UL, bytes.data(), bytes.size()));
}

void Put::text(std::string_view text) {
  number(static_cast<std::uint32_t>(text.size()));
  out_.insert(out_.end(), text.begin(), text.end());
}

void Put::bytes(std::span<const unsigned char> bytes) {
  out_.insert(out_.end(), bytes.begin(), bytes.end());
}

// A map is preceded by its length in bytes, not by its number of entries.
void Put::map(const std::map<std::string, std::string>& map) {
  const std::size_t begin = begin_length<std::uint32_t>();
  for (const auto& [key, value] : map) {
    text(key);
    text(value);
  }
  end_length<std::uint32_t>(begin);
}

// The first text is the profile, which is empty: the recording follows no convention of a
// framework.
void append_header(Bytes& out, std::string_view library) {
  Put put(out);
  const std::size_t record = put.begin_record(Op::kHeader);
  put.text("");
  put.text(library);
  put.end_record(record);
}

void append_schema(Bytes& out, const Schema& schema) {
  Put put(out);
  const std::size_t record = put.begin_record(Op::kSchema);
  put.number(schema.id);
  put.text(schema.name);
  put.text(schema.encoding);
  put.text(schema.data);
  put.end_record(record);
}

void append_channel(Bytes& out, const Channel& channel) {
  Put put(out);
  const std::size_t record = put.begin_record(Op::kChannel);
  put.number(channel.id);
  put.number(channel.schema);
  put.text(channel.topic);
  put.text(channel.encoding);
  put.map(channel.metadata);
  put.end_record(record);
}

void append_message(Bytes& out, const Message& message) {
  Put put(out);
  const std::size_t record = put.begin_record(Op::kMessage);
  put.number(message.channel);
  put.number(message.sequence);
  put.number(message.log_time_ns);
  put.number(message.publish_time_ns);
  put.bytes(message.data);
  put.end_record(record);
}

// The checksum covers the uncompressed records. They are compressed straight into `out`, whose size
// is corrected afterwards.
void append_chunk(Bytes& out, const ChunkContent& chunk, Compression compression) {
  Put put(out);
  const std::size_t record = put.begin_record(Op::kChunk);
  put.number(chunk.begin_ns);
  put.number(chunk.end_ns);
  put.number(static_cast<std::uint64_t>(chunk.records.size()));
  put.number(crc_of(chunk.records));
  put.text(compression == Compression::kZstd ? "zstd" : "");
  const std::size_t content = put.begin_length<std::uint64_t>();
  if (compression == Compression::kZstd) {
    // The fastest level: recordings are written while a mission runs.
    constexpr int kLevel = 1;
    const std::size_t bound = ::ZSTD_compressBound(chunk.records.size());
    out.resize(content + bound);
    const std::size_t size = ::ZSTD_compress(out.data() + content, bound, chunk.records.data(),
                                             chunk.records.size(), kLevel);
    SWARM_ASSERT(::ZSTD_isError(size) == 0);
    out.resize(content + size);
  } else {
    put.bytes(chunk.records);
  }
  put.end_length<std::uint64_t>(content);
  put.end_record(record);
}

// Log time and creation time are the same.
void append_attachment(Bytes& out, const Attachment& attachment) {
  Put put(out);
  const std::size_t record = put.begin_record(Op::kAttachment);
  put.number(attachment.log_time_ns);
  put.number(attachment.log_time_ns);
  put.text(attachment.name);
  put.text(attachment.media_type);
  const std::size_t data = put.begin_length<std::uint64_t>();
  out.insert(out.end(), attachment.data.begin(), attachment.data.end());
  put.end_length<std::uint64_t>(data);
  put.number(crc_of(std::span<const unsigned char>(out).subspan(record)));
  put.end_record(record);
}

void append_metadata(Bytes& out, const Metadata& metadata) {
  Put put(out);
  const std::size_t record = put.begin_record(Op::kMetadata);
  put.text(metadata.name);
  put.map(metadata.values);
  put.end_record(record);
}

// Data end, an empty footer and the magic number: a complete MCAP file without index. Made once,
// and compared with the end of existing files.
const Bytes& plain_end() {
  static const Bytes kEnd = [] {
    Bytes end;
    Put put(end);
    const std::size_t data_end = put.begin_record(Op::kDataEnd);
    put.number(std::uint32_t{0});  // no CRC of all that went before
    put.end_record(data_end);
    const std::size_t footer = put.begin_record(Op::kFooter);
    put.number(std::uint64_t{0});  // no summary
    put.number(std::uint64_t{0});
    put.number(std::uint32_t{0});
    put.end_record(footer);
    end.insert(end.end(), kMagic.begin(), kMagic.end());
    return end;
  }();
  return kEnd;
}

}  // namespace swarm::mcap
