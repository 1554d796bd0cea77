// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "robot_agent/loop/robot_log.hpp"
#include "swarm_core/blackbox/blackbox_file.hpp"

namespace swarm::agent {

/// A robot's log as a file of its own; what the disk does not take is dropped and counted.
class LogFile final : public RobotLog {
 public:
  explicit LogFile(blackbox::Writer writer) : writer_(std::move(writer)) {}

  void append(const blackbox::Step& step) override { writer_.append(step); }
  void append(const blackbox::Belief& estimate) override { writer_.append(estimate); }
  void append(blackbox::Note note) override { writer_.append(std::move(note)); }
  void append(const blackbox::LinkStats& stats) { writer_.append(stats); }

  std::uint64_t dropped() const { return writer_.dropped(); }

 private:
  blackbox::Writer writer_;
};

}  // namespace swarm::agent
