// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/run_membership.hpp"

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "swarm_core/app/run_directory.hpp"

namespace swarm::shell {
namespace {

// One file for all robots: a robot is the byte at its id. The file stays empty.
constexpr const char* kLockFile = "robots.lock";

struct flock range_of(RobotId first, std::uint32_t count) {
  struct flock range = {};
  range.l_type = F_WRLCK;
  range.l_whence = SEEK_SET;
  range.l_start = static_cast<off_t>(first.value());
  range.l_len = static_cast<off_t>(count);
  return range;
}

}  // namespace

// The launcher writes the summary after the last process has ended.
Result<void> check_run_goes_on(const std::filesystem::path& run_dir) {
  std::error_code error;
  if (!std::filesystem::exists(run_dir / kSummaryFile, error)) return {};
  return fail(
      ErrorCode::kBadInput,
      fmt::format("--run {}: this run has ended (it has a {}), so no process may add to its "
                  "record; begin another run with swarm_launcher run",
                  run_dir.string(), kSummaryFile));
}

// Locks of the open file description, not of the process: no other code of the process that closes
// the same file releases them.
Result<RobotLock> RobotLock::take(const std::filesystem::path& run_dir, RobotId first,
                                  std::uint32_t count) {
  const auto path = run_dir / kLockFile;
  // Without O_CREAT first: on a frozen file system that flag waits, even for a file that exists.
  int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0 && errno == ENOENT) file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) return RobotLock(-1);
  RobotLock lock(file);
  struct flock range = range_of(first, count);
  if (::fcntl(file, F_OFD_SETLK, &range) == 0) return lock;
  if (errno != EAGAIN && errno != EACCES) return lock;
  range = range_of(first, count);
  const bool named = ::fcntl(file, F_OFD_GETLK, &range) == 0 && range.l_type != F_UNLCK;
  return fail(ErrorCode::kBadInput,
              fmt::format("--ids: another process moves robot {} in {}; end it first",
                          named ? std::max(range.l_start, range_of(first, count).l_start)
                                : static_cast<off_t>(first.value()),
                          run_dir.string()));
}

RobotLock::RobotLock(RobotLock&& other) noexcept : file_(std::exchange(other.file_, -1)) {}

RobotLock::~RobotLock() {
  if (file_ >= 0) ::close(file_);
}

}  // namespace swarm::shell
