// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "swarm_core/base/result.hpp"
#include "swarm_core/blackbox/record.hpp"

namespace swarm::blackbox {

/// `blackbox/robot-00042.bbox` inside a run directory.
std::filesystem::path file_of(const std::filesystem::path& run_dir, RobotId robot);

/// Appends records to one robot's file, of which it is the only writer. Layout: magic "SWBBOX1\n",
/// then records of (u8 kind, u8 zero, u16 size, u32 CRC-32 of the payload, payload), little-endian.
/// Every record is one write(2), so a killed process loses at most the record it was writing. A
/// failing disk never stops the robot: the record is dropped and counted. A respawned robot's
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
  std::uint32_t waiting_ = 0;        // records
  std::uint64_t dropped_ = 0;
  std::vector<unsigned char> buffer_;
};

/// The same file, made in memory and written at once: for what cannot be killed half-way.
class Batch {
 public:
  Batch();
  void append(const Record& record);
  /// Writes the file anew. \pre its folder exists
  Result<void> write(const std::filesystem::path& file) const;

 private:
  std::vector<unsigned char> bytes_;
};

struct Damage {
  std::uint64_t damaged = 0;  ///< stretches of bytes that are no record; reading goes on after them
  bool truncated = false;     ///< the last record is incomplete (the process was killed)
};

/// Hands over every readable record in turn. Fails only if the file cannot be read or is no black
/// box at all.
Result<Damage> read_records(const std::filesystem::path& file,
                            const std::function<void(const Record&)>& take);

struct File : Damage {
  std::vector<Record> records;
};

/// Reads all records at once. A Record is as large as its largest kind (4 kB): for many robots use
/// read_records().

Result<File> read_file(const std::filesystem::path& file);

}  // namespace swarm::blackbox
