// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "swarmflow/core/result.hpp"
#include "swarm_core/robot_log/format.hpp"

namespace swarm::mcap {

/// Writes a recording: append-only, chunks of about 1 MiB, at the end an index and statistics. What
/// is not flushed yet is lost when the process is killed; everything before can be read. A failing
/// disk loses chunks, which are counted, and never the file: it goes on where there is room again.
class Writer {
 public:
  /// Makes the file anew. Fails if it exists: recordings are not overwritten.
  static Result<Writer> create(const std::filesystem::path& file,
                               Compression compression = Compression::kZstd);
  Writer(Writer&& other) noexcept { *this = std::move(other); }
  Writer& operator=(Writer&& other) noexcept;
  ~Writer();  ///< finishes

  /// Ids are given here; the same schema is written once.
  std::uint16_t add_channel(const std::string& topic, const Schema& schema,
                            const std::map<std::string, std::string>& metadata = {});
  void add(const Attachment& attachment);
  void add(const Metadata& metadata);

  /// \pre the channel was added
  void write(std::uint16_t channel, std::int64_t log_time_ns, std::int64_t publish_time_ns,
             std::span<const unsigned char> data);

  /// Hands the chunk so far to the disk.
  void flush();

  /// Index, statistics, end. Fails if anything was lost or the end could not be written.
  Result<void> finish();

  std::uint64_t messages() const { return messages_; }  ///< that are in the file
  std::uint64_t dropped() const { return dropped_; }    ///< messages that the disk did not take

 private:
  struct ChunkPlace {
    std::int64_t begin_ns = 0, end_ns = 0;
    std::uint64_t offset = 0, length = 0, index_length = 0;
    std::map<std::uint16_t, std::uint64_t> index_offsets{};
    std::uint64_t compressed = 0, uncompressed = 0;
  };
  struct Entry {
    std::int64_t log_time_ns;
    std::uint64_t offset;
  };
  struct Place {
    std::uint64_t offset = 0, length = 0;
  };

  Writer() = default;
  bool put(const Bytes& bytes);
  void append_summary(Bytes& out, std::uint64_t begin) const;

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
