// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/output.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

namespace swarm::shell {
namespace {

// stdio remembers that a write failed and not why, so the state of the pipe is asked for.
bool reader_left() {
  struct stat status {};
  if (::fstat(STDOUT_FILENO, &status) != 0) return false;
  if (!S_ISFIFO(status.st_mode) && !S_ISSOCK(status.st_mode)) return false;
  pollfd output{.fd = STDOUT_FILENO, .events = POLLOUT, .revents = 0};
  return ::poll(&output, 1, 0) > 0 && (output.revents & (POLLERR | POLLHUP)) != 0;
}

}  // namespace

// Read-only, so that printing to a closed output still fails and is reported. open() returns the
// lowest free number.
void hold_standard_streams() {
  for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd) {
    if (::fcntl(fd, F_GETFD) >= 0 || errno != EBADF) continue;
    if (::open("/dev/null", O_RDONLY) != fd) return;
  }
}

bool output_works() { return std::ferror(stdout) == 0; }

Result<void> finish_output() {
  errno = 0;
  const bool flushed = std::fflush(stdout) == 0;
  const int reason = errno;
  if ((flushed && output_works()) || reader_left()) return {};
  return fail(ErrorCode::kEnvironment,
              flushed || reason == 0
                  ? "the output could not be written; is the disk full?"
                  : fmt::format("the output could not be written: {}", std::strerror(reason)));
}

}  // namespace swarm::shell
