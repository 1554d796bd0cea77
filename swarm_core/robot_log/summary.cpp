// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The summary at the end of a recording: indexes and statistics.
#include <algorithm>
#include <array>

#include "swarm_core/robot_log/writer.hpp"

namespace swarm::mcap {

/// Number of records of each kind, the period, and the number of messages of each channel.
void Writer::append_statistics(Put& put) const {
  std::int64_t first = 0, last = 0;
  for (const ChunkPlace& chunk : chunks_) {
    first = &chunk == &chunks_.front() ? chunk.begin_ns : std::min(first, chunk.begin_ns);
    last = std::max(last, chunk.end_ns);
  }
  const std::size_t record = put.begin_record(Op::kStatistics);
  put.number(messages_);
  put.number(static_cast<std::uint16_t>(schemas_.size()));
  put.number(static_cast<std::uint32_t>(channels_.size()));
  put.number(static_cast<std::uint32_t>(attachments_.size()));
  put.number(static_cast<std::uint32_t>(metadata_.size()));
  put.number(static_cast<std::uint32_t>(chunks_.size()));
  put.number(first);
  put.number(last);
  const std::size_t map = put.begin_length<std::uint32_t>();
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    put.number(static_cast<std::uint16_t>(i));
    put.number(counts_[i]);
  }
  put.end_length<std::uint32_t>(map);
  put.end_record(record);
}

/// Position and period of a chunk, and where in the file the index of each of its channels is.
void Writer::append_chunk_index(Put& put, const ChunkPlace& chunk) const {
  const std::size_t record = put.begin_record(Op::kChunkIndex);
  put.number(chunk.begin_ns);
  put.number(chunk.end_ns);
  put.number(chunk.offset);
  put.number(chunk.length);
  const std::size_t map = put.begin_length<std::uint32_t>();
  for (const auto& [channel, offset] : chunk.index_offsets) {
    put.number(channel);
    put.number(offset);
  }
  put.end_length<std::uint32_t>(map);
  put.number(chunk.index_length);
  put.text(compression_ == Compression::kZstd ? "zstd" : "");
  put.number(chunk.compressed);
  put.number(chunk.uncompressed);
  put.end_record(record);
}

// The groups of the summary, then the offsets of these groups, the footer and the magic number.
// `begin` is the position of the summary in the file.
void Writer::append_summary(Bytes& out, std::uint64_t begin) const {
  Put put(out);
  // All records of one kind, which must be adjacent.
  struct Group {
    Op op;
    std::uint64_t offset, length;
  };
  std::vector<Group> groups;
  const auto group = [&](Op op, const auto& items, const auto& append) {
    const std::size_t from = out.size();
    for (const auto& item : items) append(item);
    if (out.size() > from) groups.push_back({op, begin + from, out.size() - from});
  };
  group(Op::kSchema, schemas_, [&](const Schema& schema) { append_schema(out, schema); });
  group(Op::kChannel, channels_, [&](const Channel& channel) { append_channel(out, channel); });
  // One record, as a group of one.
  group(Op::kStatistics, std::array{0}, [&](int) { append_statistics(put); });
  // Lets a reader find the chunks of a period, and in them the messages of a channel.
  group(Op::kChunkIndex, chunks_, [&](const ChunkPlace& chunk) { append_chunk_index(put, chunk); });
  group(Op::kAttachmentIndex, attachments_, [&](const auto& attachment) {
    const auto& [what, place] = attachment;
    const std::size_t record = put.begin_record(Op::kAttachmentIndex);
    put.number(place.offset);
    put.number(place.length);
    put.number(what.log_time_ns);
    put.number(what.log_time_ns);
    put.number(static_cast<std::uint64_t>(what.data.size()));
    put.text(what.name);
    put.text(what.media_type);
    put.end_record(record);
  });
  group(Op::kMetadataIndex, metadata_, [&](const auto& metadata) {
    const auto& [name, place] = metadata;
    const std::size_t record = put.begin_record(Op::kMetadataIndex);
    put.number(place.offset);
    put.number(place.length);
    put.text(name);
    put.end_record(record);
  });
  const std::uint64_t offsets_begin = begin + out.size();
  for (const Group& g : groups) {
    const std::size_t record = put.begin_record(Op::kSummaryOffset);
    put.number(static_cast<std::uint8_t>(g.op));
    put.number(g.offset);
    put.number(g.length);
    put.end_record(record);
  }
  // The checksum at its end is filled in below, when all bytes before it are known.
  const std::size_t footer = put.begin_record(Op::kFooter);
  put.number(begin);
  put.number(offsets_begin);
  put.number(std::uint32_t{0});
  put.end_record(footer);
  // The CRC counts everything of the summary up to itself, the footer's length included.
  const std::uint32_t crc = crc_of(std::span<const unsigned char>(out).first(out.size() - 4));
  for (std::size_t i = 0; i < 4; ++i) {
    out[out.size() - 4 + i] = static_cast<unsigned char>(crc >> (8 * i));
  }
  out.insert(out.end(), kMagic.begin(), kMagic.end());
}

}  // namespace swarm::mcap
