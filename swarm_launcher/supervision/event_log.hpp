// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "swarm_link/messages.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// Takes a line, with its newline, for a file.
using LineSink = std::function<void(std::string_view line)>;

/// Appends each line to a file at once, in the calling thread, so that a crash loses none.
LineSink append_to_file(const std::filesystem::path& file);

/// `events.jsonl`: events of a run, one JSON object per line.
class EventLog {
 public:
  explicit EventLog(LineSink sink) : sink_(std::move(sink)) {}
  void write(UtcTime at, const std::string& source, link::Severity severity,
             const std::string& code, const std::string& text);
  void write(const link::EventMessage& event);

 private:
  LineSink sink_;
};

}  // namespace swarm::launcher
