// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "swarm_link/messages.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// `events.jsonl`: events of a run, one JSON object per line, flushed at once so that a crash loses
/// none.
class EventLog {
 public:
  explicit EventLog(const std::filesystem::path& file) : out_(file, std::ios::app) {}
  void write(UtcTime at, const std::string& source, link::Severity severity,
             const std::string& code, const std::string& text);
  void write(const link::EventMessage& event);

 private:
  std::ofstream out_;
};

}  // namespace swarm::launcher
