// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "swarm_core/app/file_thread_state.hpp"
#include "swarm_core/files/append_file.hpp"
#include "swarm_core/files/disk.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::shell::detail {

/// The body of a FileThread's thread. It alone asks the disk.
class FileWorker {
 public:
  explicit FileWorker(FileThreadState& state) : s_(state), disk_(*state.disk) {}

  /// Until the thread is to finish, and everything is written or given up.
  void run();

 private:
  void wait();
  /// Writes everything that waits. `at_once`: also what failed a moment ago. True if nothing is
  /// left.
  bool pass(bool at_once);
  void append(Stream& stream, SteadyTime now);
  void remake_missing();
  void write_whole_files(SteadyTime now);
  void report();

  FileThreadState& s_;
  files::Disk& disk_;
  std::vector<Stream*> streams_;
  files::Bytes batch_;
  bool fails_ = false;
  std::uint64_t flushed_ = 0;
  SteadyTime keep_at_{};
  SteadyTime whole_retry_at_{};
  Duration whole_retry_after_{};
};

}  // namespace swarm::shell::detail
