// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "swarm_launcher/supervision/supervisor.hpp"

namespace swarm::launcher {

/// Shows the user how a run progresses.
class Display {
 public:
  virtual ~Display() = default;
  virtual void show(const std::string& headline, const std::string& details) = 0;
  /// A message that stays.
  virtual void print(const std::string& line) = 0;
};

/// One live line on a terminal, rewritten in place and cut to the terminal's width. Without a
/// terminal (or with NO_COLOR set) each change of `headline` is printed as a line and the details
/// are omitted. Writes to stderr.
class Progress final : public Display {
 public:
  Progress();
  ~Progress() override;
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(const std::string& headline, const std::string& details) override;
  /// Prints a message above the live line.
  void print(const std::string& line) override;

 private:
  void clear();
  bool live_;
  bool shown_ = false;
  std::string headline_;
};

/// Headline for the present stage of a run.
std::string headline_of(const Supervisor& supervisor);

}  // namespace swarm::launcher
