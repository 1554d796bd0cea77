// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "swarm_core/app/file_thread.hpp"
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
/// are omitted. A thread writes to stderr: a terminal that is stopped (Ctrl-S), or a pipe that no
/// one reads, delays the caller in nothing but the destructor and flush().
class Progress final : public Display {
 public:
  Progress();
  /// Waits for the output as flush() does.
  ~Progress() override;
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(const std::string& headline, const std::string& details) override;
  /// Prints a message above the live line.
  void print(const std::string& line) override;
  /// Waits until everything is written, but for a terminal that takes nothing for a second, or a
  /// pipe that takes nothing for five.
  void flush();

 private:
  /// What removes the live line, if there is one.
  std::string clear();
  bool live_;
  bool shown_ = false;
  shell::FileThread thread_;
  shell::AppendStream out_;
  std::string headline_;
};

/// Headline for the present stage of a run.
std::string headline_of(const Supervisor& supervisor);

}  // namespace swarm::launcher
