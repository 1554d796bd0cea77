// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/robot_log/mapped_file.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace swarm::mcap {

// Maps instead of reading, so that a recording larger than memory can be searched. An empty file
// cannot be mapped and has no bytes. The mapping outlives the descriptor. Without O_NONBLOCK a pipe
// would block until a writer opens it.
Result<MappedFile> MappedFile::open(const std::filesystem::path& file) {
  const auto error = [&](const char* what) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("{}: {}: {}", file.string(), what, std::strerror(errno)));
  };
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return error("cannot be opened");
  struct stat status {};
  if (::fstat(fd, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(fd);
    return fail(ErrorCode::kEnvironment, fmt::format("{}: is no file", file.string()));
  }
  const auto size = static_cast<std::size_t>(status.st_size);
  void* const mapped = size == 0 ? nullptr : ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd, 0);
  ::close(fd);
  if (mapped == MAP_FAILED) return error("cannot be mapped");
  // Readers make one pass: the kernel may read ahead and drop pages behind.
  if (mapped != nullptr) ::madvise(mapped, size, MADV_SEQUENTIAL);
  return MappedFile({static_cast<const unsigned char*>(mapped), size});
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) ::munmap(const_cast<unsigned char*>(bytes_.data()), bytes_.size());
}

}  // namespace swarm::mcap
