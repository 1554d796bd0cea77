// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "swarm_launcher/supervision/supervisor.hpp"

namespace swarm::launcher {

/// One live line on a terminal, rewritten in place and cut to the terminal's width. Without a
/// terminal (or with NO_COLOR set) each change of `headline` is printed as a line and the details
/// are omitted. Writes to stderr.
class Progress {
 public:
  Progress();
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(const std::string& headline, const std::string& details);
  /// Prints a message above the live line.
  void print(const std::string& line);

 private:
  void clear();
  bool live_;
  bool shown_ = false;
  std::string headline_;
};

/// Headline for the present stage of a run.
std::string headline_of(const Supervisor& supervisor);

}  // namespace swarm::launcher
