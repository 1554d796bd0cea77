// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/run_dir.hpp"

#include <cerrno>
#include <chrono>
#include <system_error>

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "swarm_core/app/control_socket.hpp"
#include "swarm_core/app/run_directory.hpp"

namespace swarm::shell {
namespace {

// The current directory may have been deleted: then the name stays relative.
std::filesystem::path absolute_or_same(const std::filesystem::path& path) {
  std::error_code error;
  auto absolute = std::filesystem::absolute(path, error);
  return error ? path : absolute;
}

// Local time keeps the names readable; a number is appended when two runs begin in the same second.
// The directory is made here: the one process for which it did not exist yet has claimed it.
Result<std::filesystem::path> make_default_dir(const std::string& mission) {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  const std::string name = fmt::format("{}-{:%Y%m%d-%H%M%S}", mission, fmt::localtime(now));
  const std::filesystem::path runs = "runs";
  std::error_code error;
  std::filesystem::create_directories(runs, error);
  std::filesystem::path dir = runs / name;
  for (int i = 2; !error; ++i) {
    // mkdir, which fails on what exists, whatever it is.
    if (::mkdir(dir.c_str(), 0777) == 0) return dir;
    if (errno != EEXIST) error = {errno, std::generic_category()};
    dir = runs / fmt::format("{}-{}", name, i);
  }
  return fail(ErrorCode::kEnvironment,
              fmt::format("cannot make a directory in {}: {}; name one with --out",
                          absolute_or_same(runs).string(), error.message()));
}

// A directory that the user named may exist, so making it claims nothing: a lock does, until this
// process ends. File systems without locks are used without.
bool claim(const std::filesystem::path& dir) {
  const int fd = ::open(dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return true;  // the first file that is written reports what is wrong
  if (::flock(fd, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return true;
  ::close(fd);
  return false;
}

}  // namespace

// A shared lock is refused only while the maker's exclusive one is there. On file systems without
// locks, a launcher is found by its socket.
bool is_run_alive(const std::filesystem::path& run_dir) {
  const int fd = ::open(run_dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return false;
  const bool claimed = ::flock(fd, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(fd);
  return claimed || launcher_listens(run_dir);
}

Result<std::filesystem::path> claim_dir(const std::filesystem::path& out,
                                        const std::string& mission) {
  std::filesystem::path named = out;
  if (out.empty()) {
    auto made = make_default_dir(mission);
    if (!made) return tl::unexpected(made.error());
    named = *std::move(made);
  }
  const auto dir = absolute_or_same(named);
  if (!dir.is_absolute()) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("--out {}: the current directory does not exist any more; give an "
                            "absolute path",
                            dir.string()));
  }
  std::error_code error;
  std::filesystem::create_directories(dir, error);
  if (error) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("cannot make {}: {}", dir.string(), error.message()));
  }
  if (!claim(dir)) {
    return fail(
        ErrorCode::kBadInput,
        fmt::format("--out {}: another run has begun in it; name another directory", dir.string()));
  }
  // The run file is written by the launcher of a run, so it marks a directory that is in use. A
  // directory without it is accepted even if it exists.
  if (std::filesystem::exists(dir / kRunFile, error)) {
    return fail(ErrorCode::kBadInput,
                fmt::format("--out {}: holds a run already; name another directory", dir.string()));
  }
  return dir;
}

Result<std::filesystem::path> make_run_dir(const std::filesystem::path& out,
                                           const std::string& mission) {
  auto dir = claim_dir(out, mission);
  if (!dir) return dir;
  for (const auto& folder : {kLogsFolder, kRobotLogFolder}) {
    std::error_code error;
    std::filesystem::create_directories(*dir / folder, error);
    if (error) {
      return fail(ErrorCode::kEnvironment,
                  fmt::format("cannot make {}: {}", (*dir / folder).string(), error.message()));
    }
  }
  return dir;
}

}  // namespace swarm::shell
