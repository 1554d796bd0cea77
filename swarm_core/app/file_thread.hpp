// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "swarm_core/files/append_file.hpp"
#include "swarm_core/files/disk.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::shell {

/// How well a process can write its files.
struct FileHealth {
  std::size_t failing = 0;      ///< files that cannot be written now
  std::filesystem::path first;  ///< one of them
  int error = 0;                ///< of that file, by errno; 0: the disk does not answer
  std::uint64_t lost = 0;       ///< records and whole files so far
  std::uint32_t removed = 0;    ///< files that others removed so far
};

/// What is missing in a file.
struct FileLoss {
  std::filesystem::path file;
  std::uint64_t records = 0;  ///< 0 of a file that is written as a whole: all of it
  int error = 0;              ///< the last one by errno; 0: the disk is too slow
  bool was_removed = false;   ///< others removed it, and with it what had been written
};

/// Text for people: `events.jsonl: 12 records (No space left on device)`.
std::string describe(const FileLoss& loss);

namespace detail {
struct FileThreadState;
struct Stream;
}  // namespace detail

/// One file to append records to, see FileThread::append_to(). Copies refer to the same file.
class AppendStream {
 public:
  /// Hands over a block of whole records. Never blocks and never allocates. False if the disk is so
  /// far behind that it does not fit: then it is dropped and counted. One thread at a time.
  bool push(std::span<const unsigned char> block, std::uint32_t records = 1);
  bool push(std::string_view line);
  /// Records that were dropped.
  std::uint64_t dropped() const;

 private:
  friend class FileThread;
  AppendStream(std::shared_ptr<detail::FileThreadState> state, detail::Stream& stream)
      : state_(std::move(state)), stream_(&stream) {}
  std::shared_ptr<detail::FileThreadState> state_;
  detail::Stream* stream_;
};

/// When records reach the disk.
enum class Flush : std::uint8_t {
  kAtOnce,  ///< wakes the thread
  kLazily,  ///< within a second
};

/// The thread that writes the files of a process, so that no other thread ever waits for the disk.
///
/// Records that cannot be written wait in memory and are written later, in their order; where that
/// memory is full, new ones are dropped and counted. The thread repeats what failed once a second
/// or sooner, and makes files that were removed again.
class FileThread {
 public:
  FileThread();
  explicit FileThread(std::unique_ptr<files::Disk> disk);
  /// As finish(kFinish), without its answer.
  ~FileThread();
  FileThread(const FileThread&) = delete;
  FileThread& operator=(const FileThread&) = delete;

  static constexpr Duration kFinish = std::chrono::seconds(8);

  /// A file to append to. Reserves memory for records of `capacity_bytes` that wait.
  AppendStream append_to(files::AppendFormat format, Flush flush, std::size_t capacity_bytes);

  /// Writes a whole file; of contents that wait for the same file only the newest. The newest ones
  /// are lost where more than 64 MiB wait. Allocates.
  void replace(const std::filesystem::path& file, std::string content);
  /// As replace(), and writes the file again whenever it is missing, for as long as this exists.
  void keep(const std::filesystem::path& file, std::string content);
  /// Removes a file, after everything that was handed over before.
  void remove(const std::filesystem::path& file);

  /// Never blocks for long. Any thread.
  FileHealth health(SteadyTime now) const;

  /// Waits until everything handed over so far is on the disk, for as long as the disk makes
  /// progress and `limit` without. False at the end of the limit.
  bool flush(Duration limit);

  /// Writes everything and the ends of the files, and ends the thread. Gives up after `limit`
  /// without progress, or a quarter of it where the disk refuses rather than takes its time. What
  /// is missing in which file; nothing is written afterwards.
  std::vector<FileLoss> finish(Duration limit = kFinish);

 private:
  std::shared_ptr<detail::FileThreadState> state_;
};

}  // namespace swarm::shell
