// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "swarmflow/core/result.hpp"

namespace swarm::shell {

/// A file in memory, which processes of the same user can read by its path for as long as this
/// process runs: it needs no disk, and no one can remove it.
class MemoryFile {
 public:
  /// Fails (kEnvironment) if the system has no such files.
  static Result<MemoryFile> make(const std::string& name, std::string_view content);
  MemoryFile(MemoryFile&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  MemoryFile& operator=(MemoryFile&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~MemoryFile();

  /// `/proc/<process>/fd/<number>`.
  std::string path() const;

 private:
  explicit MemoryFile(int fd) : fd_(fd) {}
  int fd_ = -1;
};

}  // namespace swarm::shell
