// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "swarmflow/core/result.hpp"
#include "swarm_core/robot_log/record.hpp"
#include "swarm_core/robot_log/record_codec.hpp"
#include "swarm_core/robot_log/format.hpp"
#include "swarm_core/robot_log/reader.hpp"

namespace swarm::robot_log {

/// `robot_log/robot-00042.mcap` inside a run directory.
std::filesystem::path file_of(const std::filesystem::path& run_dir, RobotId robot);

/// Makes messages of records and chunks of messages. A robot's first record is its Header.
class RecordEncoder {
 public:
  RecordEncoder();
  void add(const Record& record);
  std::uint32_t waiting() const { return chunk_.messages; }
  /// Appends what waits, as one chunk.
  void move_chunk(mcap::Bytes& out, mcap::Compression compression);

 private:
  RobotId robot_{};
  std::uint32_t sequence_ = 0;
  mcap::ChunkContent chunk_{};
  mcap::Bytes message_{};
};

/// Appends records to one robot's file, of which it is the only writer: an MCAP file, whose
/// messages idl/blackbox.idl describes, every chunk with a checksum and one write(2). So a killed
/// process loses at most the record it was writing, and its file lacks an end, which readers take.
/// A failing disk never stops the robot: the record is dropped and counted. A respawned robot's
/// process appends to the same file.
class Writer {
 public:
  /// Creates the file and its folder if need be. Writes `at_once` records at a time, the first time
  /// `turn` records earlier: what is not written yet is lost when the process is killed.
  static Result<Writer> open(const std::filesystem::path& file, std::uint32_t at_once = 1,
                             std::uint32_t turn = 0);
  Writer(Writer&& other) noexcept;
  Writer& operator=(Writer&& other) noexcept;
  ~Writer();

  void append(const Record& record);
  std::uint64_t dropped() const { return dropped_; }

 private:
  Writer(int fd, std::uint32_t at_once, std::uint32_t turn)
      : fd_(fd), at_once_(at_once), until_written_(at_once - turn) {}
  void write();

  int fd_ = -1;
  std::uint32_t at_once_ = 1;
  std::uint32_t until_written_ = 1;  // records
  std::uint64_t dropped_ = 0;
  RecordEncoder encoder_;
  mcap::Bytes buffer_;
};

/// The same file, compressed, made in memory and written at once: for what cannot be killed
/// half-way.
class Batch {
 public:
  Batch();
  void append(const Record& record);
  /// Writes the file anew. Once. \pre its folder exists
  Result<void> write(const std::filesystem::path& file);

 private:
  RecordEncoder encoder_;
  mcap::Bytes bytes_;
};

using Damage = mcap::Damage;

/// The record that a message of any recording holds, or nothing if it is none.
std::optional<RobotRecord> decode(const mcap::Message& message, const mcap::Channel& channel);

/// Hands over every readable record in turn. Fails only if the file cannot be read or is no black
/// box at all.
Result<Damage> read_records(const std::filesystem::path& file,
                            const std::function<void(const Record&)>& take);

/// The last two steps a robot recorded, the newest last; fewer if it recorded no more, or has no
/// file.
Result<std::vector<Step>> last_steps(const std::filesystem::path& file);

struct File : Damage {
  std::vector<Record> records;
};

/// Reads all records at once. A Record is as large as its largest kind (4 kB): for many robots use
/// read_records().
Result<File> read_file(const std::filesystem::path& file);

}  // namespace swarm::robot_log
