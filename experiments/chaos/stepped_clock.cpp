// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/stepped_clock.hpp"

#include <cstdlib>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "swarm_launcher/processes/child_process.hpp"

namespace swarm::launcher {
namespace {

constexpr const char* kPreload = "LD_PRELOAD";
constexpr const char* kOffsetFile = "SWARM_CLOCK_OFFSET_FILE";

/// Beside the programs, in a build and in an installation.
std::filesystem::path library() {
  return (sibling_program("..") / SWARM_CLOCK_SHIM).lexically_normal();
}

}  // namespace

Result<std::unique_ptr<SteppedClock>> SteppedClock::make(const std::filesystem::path& file) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return fail(ErrorCode::kEnvironment, "a sanitizer's library must be the first that is loaded");
#endif
  if (!std::filesystem::exists(library())) {
    return fail(ErrorCode::kEnvironment, "there is no " + library().string());
  }
  const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  void* at = MAP_FAILED;
  if (fd >= 0 && ::ftruncate(fd, sizeof(std::int64_t)) == 0) {
    at = ::mmap(nullptr, sizeof(std::int64_t), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  }
  if (fd >= 0) ::close(fd);
  if (at == MAP_FAILED) return fail(ErrorCode::kEnvironment, "cannot write " + file.string());
  ::setenv(kPreload, library().c_str(), 1);
  ::setenv(kOffsetFile, file.c_str(), 1);
  return std::unique_ptr<SteppedClock>(
      new SteppedClock(file, static_cast<volatile std::int64_t*>(at)));
}

SteppedClock::~SteppedClock() {
  ::unsetenv(kPreload);
  ::unsetenv(kOffsetFile);
  ::munmap(const_cast<std::int64_t*>(offset_s_), sizeof(std::int64_t));
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

void SteppedClock::step(std::int64_t seconds) { *offset_s_ = *offset_s_ + seconds; }

}  // namespace swarm::launcher
