// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "swarm_core/files/append_file.hpp"
#include "swarm_core/robot_log/format.hpp"
#include "swarm_core/robot_log/reader.hpp"
#include "swarm_core/robot_log/record.hpp"
#include "swarm_core/robot_log/record_codec.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::robot_log {

/// The log of a robot inside a run directory: `blackbox/robot-00042.mcap`.
std::filesystem::path file_of(const std::filesystem::path& run_dir, RobotId robot);

/// Encodes records as messages and collects the messages in chunks. A robot's first record is its
/// Header. Messages are numbered from 0 on, so that readers find gaps.
class RecordEncoder {
 public:
  RecordEncoder();
  /// Encodes a record into the current chunk. \pre the first one is the robot's Header
  void add(const Record& record);
  /// Number of records in the current chunk.
  std::uint32_t waiting() const { return chunk_.messages; }
  /// Appends the current chunk to `out` and begins the next one.
  void move_chunk(mcap::Bytes& out, mcap::Compression compression);

 private:
  RobotId robot_{};
  std::uint32_t sequence_ = 0;
  mcap::ChunkContent chunk_{};
  mcap::Bytes message_{};
};

/// Where a Writer puts its chunks: a file, or a queue of one.
class ChunkSink {
 public:
  virtual ~ChunkSink() = default;
  /// Takes a whole chunk or drops it.
  virtual void append(std::span<const unsigned char> chunk, std::uint32_t records) = 0;
  /// Number of records that were dropped.
  virtual std::uint64_t dropped() const = 0;
};

/// The file of a robot's log, as its process appends to it: every chunk is written behind this
/// header, in a file that may be that of an earlier incarnation, or may have to be made again.
files::AppendFormat format_of(std::filesystem::path file, const Header& header);

/// Encodes the records of one robot, chunk by chunk: MCAP, whose messages idl/blackbox.idl
/// describes, every chunk with a checksum. A killed process loses at most the records that are not
/// in the file yet, and its file lacks an end, which readers accept. A failing disk never stops the
/// robot: the record is dropped and counted. A respawned robot's process appends to the same file.
class Writer {
 public:
  /// Writes to a file at once, in the calling thread; creates it and its folder if they do not
  /// exist. The first record is the robot's Header. Puts `at_once` records into a chunk, the first
  /// time `turn` records earlier. Records that are not written are lost when the process is killed.
  static Result<Writer> open(const std::filesystem::path& file, std::uint32_t at_once = 1,
                             std::uint32_t turn = 0);
  /// Hands the chunks to a sink that has the header already (format_of()).
  static Writer to(std::unique_ptr<ChunkSink> sink, const Header& header, std::uint32_t at_once = 1,
                   std::uint32_t turn = 0);
  Writer(Writer&& other) noexcept = default;
  Writer& operator=(Writer&& other) noexcept;
  ~Writer();

  /// Records one record; the sink gets it with the next chunk. Never fails, see dropped().
  void append(const Record& record);
  /// Number of records that the sink refused.
  std::uint64_t dropped() const { return sink_->dropped(); }
  /// Hands over the records of the chunk that is being filled.
  void flush();

 private:
  Writer(std::unique_ptr<ChunkSink> sink, std::uint32_t at_once, std::uint32_t turn)
      : sink_(std::move(sink)), at_once_(at_once), until_written_(at_once - turn) {}

  std::unique_ptr<ChunkSink> sink_;
  std::uint32_t at_once_ = 1;
  std::uint32_t until_written_ = 1;  // records
  RecordEncoder encoder_;
  mcap::Bytes buffer_;
};

/// The same file, compressed, made in memory and written at once: for logs that are complete before
/// they are written, as those of a simulation.
class Batch {
 public:
  Batch();
  void append(const Record& record);
  /// Writes the file, replacing an existing one. Called once. \pre its folder exists
  Result<void> write(const std::filesystem::path& file);

 private:
  RecordEncoder encoder_;
  mcap::Bytes bytes_;
};

/// What was wrong with a robot's log.
struct Damage : mcap::Damage {
  /// Records that the numbering of the messages lacks: those that the disk did not take, and those
  /// that damage hides. An incarnation begins with number 0.
  std::uint64_t lost = 0;
};

/// Counts the records that the numbering of a robot log lacks, by the numbers of its messages in
/// the order of the file.
class LostRecords {
 public:
  void add(std::uint32_t sequence) {
    if (sequence > expected_) count_ += sequence - expected_;
    expected_ = sequence + 1;
  }
  std::uint64_t count() const { return count_; }

 private:
  std::uint64_t count_ = 0;
  std::uint32_t expected_ = 0;  // an incarnation begins at 0
};

/// The metadata of a merged recording, and in it the number of records that its logs lacked: the
/// recording numbers its messages anew.
inline constexpr std::string_view kMergeMetadata = "swarmflow";
inline constexpr std::string_view kMergeLost = "lost";

/// The robot-log record in a message of any recording; nothing if the message is not one.
std::optional<RobotRecord> decode(const mcap::Message& message, const mcap::Channel& channel);

/// Calls `take` for every readable record in turn that is not older than `from`. Fails only if the
/// file cannot be read or is not a robot log at all.
Result<Damage> read_records(const std::filesystem::path& file,
                            const std::function<void(const Record&)>& take,
                            UtcTime from = UtcTime::min());

/// The last two steps a robot recorded, the newest last; fewer if it recorded no more, or has no
/// file. Parts of the file from before `from` are passed over without being unpacked: a caller that
/// must not wait names a recent time, as a log grows by some megabytes an hour.
Result<std::vector<Step>> last_steps(const std::filesystem::path& file,
                                     UtcTime from = UtcTime::min());

/// All records of a file and what was wrong with it.
struct File : Damage {
  std::vector<Record> records;
};

/// Reads all records at once. A Record is as large as its largest kind (4 kB): for many robots use
/// read_records().
Result<File> read_file(const std::filesystem::path& file);

}  // namespace swarm::robot_log
