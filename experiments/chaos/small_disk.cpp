// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/small_disk.hpp"

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

namespace swarm::launcher {

namespace fs = std::filesystem;

Result<void> own_mounts() {
  if (::unshare(CLONE_NEWNS) == 0 &&
      ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0) {
    return {};
  }
  return fail(ErrorCode::kEnvironment,
              fmt::format("needs root, for a file system of its own: {}", std::strerror(errno)));
}

Result<std::unique_ptr<SmallDisk>> SmallDisk::make(const fs::path& folder, std::uint64_t bytes) {
  std::error_code error;
  fs::create_directories(folder, error);
  const std::string size = fmt::format("size={}", bytes);
  if (::mount("tmpfs", folder.c_str(), "tmpfs", 0, size.c_str()) != 0) {
    return fail(ErrorCode::kEnvironment, fmt::format("cannot mount a file system at {}: {}",
                                                     folder.string(), std::strerror(errno)));
  }
  return std::unique_ptr<SmallDisk>(new SmallDisk(folder));
}

// Copied before the file system goes, since nothing can be copied to a folder below it. Sockets
// cannot be copied.
SmallDisk::~SmallDisk() {
  free();
  const fs::path copy = folder_.string() + ".copy";
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_, error)) {
    std::error_code gone;
    if (entry.is_socket(gone)) fs::remove(entry.path(), gone);
  }
  fs::copy(folder_, copy, fs::copy_options::recursive | fs::copy_options::copy_symlinks, error);
  ::umount2(folder_.c_str(), MNT_DETACH);
  if (!error) fs::rename(copy, folder_, error);
}

// A block at a time at the end, where a large piece does not fit any more.
bool SmallDisk::fill() {
  if (is_full_) return false;
  const int fd = ::open(filler().c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (fd < 0) return false;
  off_t size = 0;
  for (off_t piece = 1 << 20; piece >= 4096;) {
    if (::posix_fallocate(fd, size, piece) == 0) {
      size += piece;
    } else {
      piece /= 2;
    }
  }
  ::close(fd);
  is_full_ = true;
  return true;
}

void SmallDisk::free() {
  std::error_code ignored;
  fs::remove(filler(), ignored);
  is_full_ = false;
}

}  // namespace swarm::launcher
