// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

#include "swarm_core/files/disk.hpp"

namespace swarm::files {

using Bytes = std::vector<unsigned char>;

/// A file to append to, and what it holds beside the records.
struct AppendFormat {
  std::filesystem::path file;
  Bytes preamble{};    ///< at the begin of an empty file
  Bytes begin{};       ///< before the first record of this writer
  Bytes end{};         ///< after its last record; the next writer removes it
  Bytes record_end{};  ///< last bytes of every record, if they are the same; also end a torn one
};

/// Lines of text.
inline AppendFormat lines_of(std::filesystem::path file) {
  return {.file = std::move(file), .record_end = {'\n'}};
}

/// A file of which one process at a time is the writer. Records are written whole or not at all: a
/// part of one that a full disk took is removed. A file that was removed is made again, with its
/// preamble. No thread, no clock: the caller repeats what failed. Not thread-safe.
class AppendFile {
 public:
  explicit AppendFile(AppendFormat format) : format_(std::move(format)) {}

  /// Opens the file. Called by append() where it has not been. 0 or the error.
  int open(Disk& disk);
  /// Blocks for as long as the disk does.
  int append(Disk& disk, std::span<const unsigned char> bytes);
  /// Writes the end and closes the file. 0 or the error. Without an open file it does nothing.
  int finish(Disk& disk);

  const std::filesystem::path& file() const { return format_.file; }
  /// How often the file had been removed when something was to be appended.
  std::uint32_t times_removed() const { return times_removed_; }

 private:
  int write_whole(Disk& disk, const Disk::State& before, std::span<const unsigned char> bytes);
  void remove_end(Disk& disk, Disk::State& state);
  void close(Disk& disk);

  AppendFormat format_;
  int fd_ = -1;
  bool has_begun_ = false;  ///< `begin` is in the file
  bool is_torn_ = false;    ///< the file ends with a part of a record
  std::uint32_t times_removed_ = 0;
  Bytes buffer_;
};

}  // namespace swarm::files
