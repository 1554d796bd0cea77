// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "swarm_monitor/view/live_source.hpp"
#include "swarm_monitor/view/page_session.hpp"

namespace swarm::monitor {

/// The launcher's command line for a control request, as `swarm_launcher command` sends it. A goal
/// request moves the present goal as a whole: its mean goes to the given point.
std::string command_line_of(const ControlRequest& request, const Mixture& goal);

/// Sends viewers' requests to the launcher of a run, in a thread of its own, since a launcher
/// answers when a command is done. The outcome appears in the run's events.
class RemoteControl {
 public:
  RemoteControl(std::filesystem::path run_dir, const LiveSource& source);
  ~RemoteControl();

  /// Returns that the launcher was asked, or why not.
  Result<std::string> ask(const ControlRequest& request);

 private:
  class Worker;
  const LiveSource& source_;
  std::unique_ptr<Worker> worker_;
};

/// A secret for a URL, by the kernel's generator.
std::string make_token();

}  // namespace swarm::monitor
