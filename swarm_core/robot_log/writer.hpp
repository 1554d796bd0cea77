// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "swarm_core/robot_log/format.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::mcap {

/// Writes a recording: append-only, in chunks of about 1 MiB, with index and statistics at the end.
/// A process that is killed loses the messages that are not flushed; all earlier ones can be read.
/// A full disk loses chunks, whose messages are counted; writing continues when there is room
/// again.
class Writer {
 public:
  /// Creates the file. Fails if it exists: recordings are not overwritten.
  static Result<Writer> create(const std::filesystem::path& file,
                               Compression compression = Compression::kZstd);
  Writer(Writer&& other) noexcept { *this = std::move(other); }
  Writer& operator=(Writer&& other) noexcept;
  ~Writer();  ///< finishes

  /// Adds a channel and returns its id; equal schemas are written once.
  std::uint16_t add_channel(const std::string& topic, const Schema& schema,
                            const std::map<std::string, std::string>& metadata = {});
  void add(const Attachment& attachment);
  void add(const Metadata& metadata);

  /// \pre the channel was added
  void write(std::uint16_t channel, std::int64_t log_time_ns, std::int64_t publish_time_ns,
             std::span<const unsigned char> data);

  /// Writes the current chunk to the disk.
  void flush();

  /// Writes index, statistics and end. Fails if messages were lost or the end could not be written.
  Result<void> finish();

  std::uint64_t messages() const { return messages_; }  ///< that are in the file
  std::uint64_t dropped() const { return dropped_; }    ///< messages that the disk did not take

 private:
  /// Where a chunk is in the file and what it contains, for its index record.
  struct ChunkPlace {
    std::int64_t begin_ns = 0, end_ns = 0;
    std::uint64_t offset = 0, length = 0, index_length = 0;
    std::map<std::uint16_t, std::uint64_t> index_offsets{};
    std::uint64_t compressed = 0, uncompressed = 0;
  };
  /// A message of the chunk being filled, for the message index.
  struct Entry {
    std::int64_t log_time_ns;
    std::uint64_t offset;
  };
  /// Position and length of a record in the file.
  struct Place {
    std::uint64_t offset = 0, length = 0;
  };

  Writer() = default;
  bool put(const Bytes& bytes);
  void append_summary(Bytes& out, std::uint64_t begin) const;
  void append_statistics(Put& put) const;
  void append_chunk_index(Put& put, const ChunkPlace& chunk) const;

  int fd_ = -1;
  std::filesystem::path file_{};
  Compression compression_ = Compression::kZstd;
  std::uint64_t size_ = 0;
  std::vector<Schema> schemas_{};
  std::vector<Channel> channels_{};
  std::vector<std::uint32_t> sequences_{};     // by channel
  std::vector<std::uint64_t> counts_{};        // by channel, of messages in the file
  std::vector<std::vector<Entry>> entries_{};  // by channel, of the chunk being filled
  ChunkContent chunk_{};
  std::vector<ChunkPlace> chunks_{};
  std::vector<std::pair<Attachment, Place>> attachments_{};  // without their data
  std::vector<std::pair<std::string, Place>> metadata_{};
  Bytes scratch_{};
  Bytes lost_declarations_{};  // schemas and channels that the disk did not take yet
  std::uint64_t messages_ = 0, dropped_ = 0;
};

}  // namespace swarm::mcap
