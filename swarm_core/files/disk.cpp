// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/files/disk.hpp"

#include <cerrno>
#include <cstdio>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace swarm::files {
namespace {

// A file that exists is opened without O_CREAT, which a frozen file system would not answer.
int open_or_make(const std::filesystem::path& file) {
  constexpr int kHow = O_RDWR | O_APPEND | O_CLOEXEC | O_NOCTTY;
  const int fd = ::open(file.c_str(), kHow);
  if (fd >= 0 || errno != ENOENT) return fd;
  return ::open(file.c_str(), kHow | O_CREAT, 0644);
}

int write_all(int fd, std::string_view content) {
  while (!content.empty()) {
    const ssize_t bytes = ::write(fd, content.data(), content.size());
    if (bytes < 0 && errno == EINTR) continue;
    if (bytes < 0) return errno;
    content.remove_prefix(static_cast<std::size_t>(bytes));
  }
  return 0;
}

}  // namespace

Disk::Answer<int> RealDisk::open(const std::filesystem::path& file) {
  int fd = open_or_make(file);
  if (fd < 0 && errno == ENOENT) {
    std::error_code error;
    std::filesystem::create_directories(file.parent_path(), error);
    if (error) return tl::unexpected(error.value());
    fd = open_or_make(file);
  }
  if (fd < 0) return tl::unexpected(errno);
  return fd;
}

Disk::Answer<Disk::State> RealDisk::state(int fd) {
  struct stat status {};
  if (::fstat(fd, &status) != 0) return tl::unexpected(errno);
  return State{.size = static_cast<std::uint64_t>(status.st_size),
               .is_regular = S_ISREG(status.st_mode),
               .is_linked = status.st_nlink > 0};
}

Disk::Answer<std::size_t> RealDisk::write(int fd, std::span<const unsigned char> bytes) {
  for (;;) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written > 0) return static_cast<std::size_t>(written);
    if (written == 0) return tl::unexpected(ENOSPC);
    if (errno != EINTR) return tl::unexpected(errno);
  }
}

Disk::Answer<std::size_t> RealDisk::read_at(int fd, std::uint64_t offset,
                                            std::span<unsigned char> bytes) {
  const ssize_t read = ::pread(fd, bytes.data(), bytes.size(), static_cast<off_t>(offset));
  if (read < 0) return tl::unexpected(errno);
  return static_cast<std::size_t>(read);
}

int RealDisk::truncate(int fd, std::uint64_t size) {
  return ::ftruncate(fd, static_cast<off_t>(size)) == 0 ? 0 : errno;
}

void RealDisk::close(int fd) { ::close(fd); }

// The process id keeps two processes from writing the same temporary file.
int RealDisk::replace(const std::filesystem::path& file, std::string_view content) {
  const std::string temporary = file.string() + ".tmp" + std::to_string(::getpid());
  constexpr int kHow = O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC;
  int fd = ::open(temporary.c_str(), kHow, 0644);
  if (fd < 0 && errno == ENOENT) {
    std::error_code error;
    std::filesystem::create_directories(file.parent_path(), error);
    if (error) return error.value();
    fd = ::open(temporary.c_str(), kHow, 0644);
  }
  if (fd < 0) return errno;
  int error = write_all(fd, content);
  ::close(fd);
  if (error == 0 && ::rename(temporary.c_str(), file.c_str()) != 0) error = errno;
  // What was written of it would take room on a full disk.
  if (error != 0) ::unlink(temporary.c_str());
  return error;
}

int RealDisk::remove(const std::filesystem::path& file) {
  return ::unlink(file.c_str()) == 0 || errno == ENOENT ? 0 : errno;
}

bool RealDisk::exists(const std::filesystem::path& file) {
  return ::access(file.c_str(), F_OK) == 0;
}

Disk::Answer<int> StreamDisk::open(const std::filesystem::path& /*file*/) { return fd_; }

// A file behind the stream may belong to others, too, and is never cut.
Disk::Answer<Disk::State> StreamDisk::state(int /*fd*/) {
  return State{.size = 1, .is_regular = false, .is_linked = true};
}

void StreamDisk::close(int /*fd*/) {}

}  // namespace swarm::files
