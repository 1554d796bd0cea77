// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <semaphore.h>

#include "swarm_core/app/file_thread.hpp"
#include "swarm_core/app/record_ring.hpp"
#include "swarm_core/files/append_file.hpp"
#include "swarm_core/files/disk.hpp"

/// What a FileThread and its thread share.
namespace swarm::shell::detail {

/// A file that is appended to. What has no other comment belongs to the thread.
struct Stream {
  Stream(files::AppendFormat format, Flush how, std::size_t capacity_bytes)
      : ring(capacity_bytes), file(std::move(format)), flush(how) {}

  RecordRing ring;
  files::AppendFile file;
  const Flush flush;
  std::atomic<std::uint64_t> dropped{0};
  std::atomic<int> last_error{0};
  std::atomic<bool> was_removed{false};
  int error = 0;
  SteadyTime retry_at{};
  Duration retry_after{};
};

/// Content of a file that waits to be written; null: it is to be removed.
using Content = std::shared_ptr<const std::string>;

struct FileThreadState {
  explicit FileThreadState(std::unique_ptr<files::Disk> d) : disk(std::move(d)) {
    ::sem_init(&work, 0, 0);
  }
  ~FileThreadState() { ::sem_destroy(&work); }
  FileThreadState(const FileThreadState&) = delete;
  FileThreadState& operator=(const FileThreadState&) = delete;

  void wake() {
    if (!is_awake.exchange(true)) ::sem_post(&work);
  }

  const std::unique_ptr<files::Disk> disk;
  sem_t work{};
  std::atomic<bool> is_awake{false};
  std::atomic<std::uint64_t> lost{0};
  std::atomic<std::uint32_t> removed{0};
  std::atomic<std::uint64_t> progress{0};      ///< writes that succeeded
  std::atomic<std::int64_t> busy_since_ns{0};  ///< begin of the present pass; 0: it waits
  std::atomic<bool> is_finishing{false};
  std::atomic<bool> is_abandoned{false};
  std::atomic<std::uint64_t> flushes_wanted{0};
  std::atomic<const Stream*> at{nullptr};  ///< the file that the thread writes

  mutable std::mutex mutex;  ///< of everything below; never held while the disk is asked
  std::condition_variable changed;
  std::deque<Stream> streams;
  std::map<std::filesystem::path, Content> waiting;  ///< whole files
  std::map<std::filesystem::path, Content> kept;
  std::map<std::filesystem::path, int> whole_errors;
  std::vector<std::filesystem::path> whole_lost;
  std::size_t waiting_bytes = 0;
  std::uint64_t flushes_done = 0;
  FileHealth health;
  bool has_ended = false;
  std::thread thread;
};

}  // namespace swarm::shell::detail
