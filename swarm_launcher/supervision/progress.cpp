// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/supervision/progress.hpp"

#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>
#include <unistd.h>

namespace swarm::launcher {

// Control sequences are written to terminals only, and not if the user set NO_COLOR.
Progress::Progress() : live_(::isatty(STDERR_FILENO) == 1 && std::getenv("NO_COLOR") == nullptr) {}

Progress::~Progress() {
  if (shown_) std::fputc('\n', stderr);
}

// Carriage return, then "erase to the end of the line".
void Progress::clear() {
  if (shown_) std::fputs("\r\033[K", stderr);
  shown_ = false;
}

// Without a terminal only changes of the headline are printed, so that logs stay short.
void Progress::show(const std::string& headline, const std::string& details) {
  if (live_) {
    clear();
    std::fprintf(stderr, "%s  %s", headline.c_str(), details.c_str());
    std::fflush(stderr);
    shown_ = true;
  } else if (headline != headline_) {
    std::fprintf(stderr, "%s\n", headline.c_str());
  }
  headline_ = headline;
}

void Progress::print(const std::string& line) {
  clear();
  std::fprintf(stderr, "%s\n", line.c_str());
}

std::string headline_of(const Supervisor& supervisor) {
  switch (supervisor.stage()) {
    case Supervisor::Stage::kStarting:
      return fmt::format("starting {} processes", supervisor.processes());
    case Supervisor::Stage::kGathering:
      return "waiting for all robots to be received";
    case Supervisor::Stage::kRunning:
      return fmt::format("mission {}", to_string(supervisor.phase()));
    case Supervisor::Stage::kEnding:
      return "ending all processes";
    case Supervisor::Stage::kDone:
      return "all processes ended";
  }
  return "";
}

}  // namespace swarm::launcher
