// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/run_dir.hpp"

#include <chrono>
#include <system_error>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "swarm_core/app/run_directory.hpp"

namespace swarm::shell {
namespace {

// Local time keeps the names readable; a number is appended when two runs begin in the same second.
std::filesystem::path default_run_dir(const std::string& mission) {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  const std::string name = fmt::format("{}-{:%Y%m%d-%H%M%S}", mission, fmt::localtime(now));
  const std::filesystem::path runs = "runs";
  std::filesystem::path dir = runs / name;
  std::error_code error;
  for (int i = 2; std::filesystem::exists(dir, error); ++i)
    dir = runs / fmt::format("{}-{}", name, i);
  return dir;
}

}  // namespace

Result<std::filesystem::path> make_run_dir(const std::filesystem::path& out,
                                           const std::string& mission) {
  const auto dir = std::filesystem::absolute(out.empty() ? default_run_dir(mission) : out);
  std::error_code error;
  // The run file is written by the launcher of a run, so it marks a directory that is in use. A
  // directory without it is accepted even if it exists.
  if (std::filesystem::exists(dir / kRunFile, error)) {
    return fail(ErrorCode::kBadInput,
                fmt::format("--out {}: holds a run already; name another directory", dir.string()));
  }
  for (const auto& folder : {kLogsFolder, kRobotLogFolder}) {
    std::filesystem::create_directories(dir / folder, error);
    if (error) {
      return fail(ErrorCode::kEnvironment,
                  fmt::format("cannot make {}: {}", (dir / folder).string(), error.message()));
    }
  }
  return dir;
}

}  // namespace swarm::shell
