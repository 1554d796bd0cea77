// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/supervision/progress.hpp"

#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "swarm_core/files/disk.hpp"

namespace swarm::launcher {
namespace {

// Minutes of the live line on a terminal that is stopped.
constexpr std::size_t kWaitingBytes = 256U << 10U;
// A terminal whose user stopped the output; a pipe whose reader is slow.
constexpr Duration kTerminalTimeout = std::chrono::seconds(1);
constexpr Duration kPipeTimeout = std::chrono::seconds(5);

Duration timeout() { return ::isatty(STDERR_FILENO) == 1 ? kTerminalTimeout : kPipeTimeout; }

/// Characters of the live line: one less than the terminal is wide, since some terminals begin the
/// next row with the last column. A terminal that does not know its width has no limit.
std::size_t room() {
  winsize size{};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col - 1U : std::numeric_limits<std::size_t>::max();
}

/// The first characters of a text in UTF-8.
std::string first_of(const std::string& text, std::size_t characters) {
  std::size_t end = 0;
  for (; end < text.size(); ++end) {
    const bool begins = (static_cast<unsigned char>(text[end]) & 0xC0U) != 0x80U;
    if (begins && characters-- == 0) break;
  }
  return text.substr(0, end);
}

}  // namespace

// Control sequences are written to terminals only, and not if the user set NO_COLOR.
Progress::Progress()
    : live_(::isatty(STDERR_FILENO) == 1 && std::getenv("NO_COLOR") == nullptr),
      thread_(std::make_unique<files::StreamDisk>(STDERR_FILENO)),
      out_(thread_.append_to({.file = "stderr"}, shell::Flush::kAtOnce, kWaitingBytes)) {}

Progress::~Progress() {
  if (shown_) out_.push("\n");
  thread_.finish(timeout());
}

void Progress::flush() { thread_.flush(timeout()); }

// Carriage return, then "erase to the end of the line".
std::string Progress::clear() { return std::exchange(shown_, false) ? "\r\033[K" : ""; }

// A line that is wrapped could not be rewritten: only its last row would be erased. Without a
// terminal only changes of the headline are printed, so that logs stay short.
void Progress::show(const std::string& headline, const std::string& details) {
  if (live_) {
    out_.push(clear() + first_of(headline + "  " + details, room()));
    shown_ = true;
  } else if (headline != headline_) {
    out_.push(headline + "\n");
  }
  headline_ = headline;
}

void Progress::print(const std::string& line) { out_.push(clear() + line + "\n"); }

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
