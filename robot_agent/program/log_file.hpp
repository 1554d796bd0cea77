// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>

#include "robot_agent/loop/robot_log.hpp"
#include "swarm_core/robot_log/robot_log_file.hpp"

namespace swarm::agent {

/// A robot's log as a file; records that cannot be written are dropped and counted.
class LogFile final : public RobotLog {
 public:
  explicit LogFile(robot_log::Writer writer) : writer_(std::move(writer)) {}

  void append(const robot_log::Step& step) override { writer_.append(step); }
  void append(const robot_log::Estimate& estimate) override { writer_.append(estimate); }
  void append(robot_log::Note note) override { writer_.append(std::move(note)); }
  void append(const robot_log::LinkStats& stats) { writer_.append(stats); }

  std::uint64_t dropped() const { return writer_.dropped(); }

 private:
  robot_log::Writer writer_;
};

}  // namespace swarm::agent
