// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/memory_file.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

namespace swarm::shell {

Result<MemoryFile> MemoryFile::make(const std::string& name, std::string_view content) {
  MemoryFile file(::memfd_create(name.c_str(), MFD_CLOEXEC | MFD_ALLOW_SEALING));
  bool written = file.fd_ >= 0;
  while (written && !content.empty()) {
    const ssize_t bytes = ::write(file.fd_, content.data(), content.size());
    if (bytes < 0 && errno == EINTR) continue;
    written = bytes > 0;
    if (written) content.remove_prefix(static_cast<std::size_t>(bytes));
  }
  if (!written) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("cannot keep {} in memory: {}", name, std::strerror(errno)));
  }
  // Readers of other processes cannot change it.
  ::fcntl(file.fd_, F_ADD_SEALS, F_SEAL_WRITE | F_SEAL_GROW | F_SEAL_SHRINK | F_SEAL_SEAL);
  return file;
}

MemoryFile::~MemoryFile() {
  if (fd_ >= 0) ::close(fd_);
}

std::string MemoryFile::path() const { return fmt::format("/proc/{}/fd/{}", ::getpid(), fd_); }

}  // namespace swarm::shell
