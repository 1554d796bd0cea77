// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "robot_agent/loop/robot_log.hpp"
#include "swarm_core/app/file_thread.hpp"
#include "swarm_core/app/shared_steps.hpp"
#include "swarm_core/robot_log/robot_log_file.hpp"

namespace swarm::agent {

/// Hands the chunks of a robot's log to the thread that writes them.
class QueuedChunks final : public robot_log::ChunkSink {
 public:
  explicit QueuedChunks(shell::AppendStream stream) : stream_(std::move(stream)) {}

  void append(std::span<const unsigned char> chunk, std::uint32_t records) override {
    stream_.push(chunk, records);
  }
  std::uint64_t dropped() const override { return stream_.dropped(); }

 private:
  shell::AppendStream stream_;
};

/// A robot's log as a file; records that find no room are dropped and counted. Steps also go to the
/// memory that the process shares with its launcher, if it has one.
class LogFile final : public RobotLog {
 public:
  /// `steps` outlives the object and has a place for the robot; null: there is none.
  LogFile(robot_log::Writer writer, RobotId robot, shell::SharedSteps* steps)
      : writer_(std::move(writer)), robot_(robot), steps_(steps) {}

  void append(const robot_log::Step& step) override {
    if (steps_ != nullptr) steps_->record(robot_, step);
    writer_.append(step);
  }
  void append(const robot_log::Estimate& estimate) override { writer_.append(estimate); }
  void append(robot_log::Note note) override { writer_.append(std::move(note)); }
  void append(const robot_log::LinkStats& stats) { writer_.append(stats); }
  /// Hands over what waits for a chunk to be full.
  void flush() { writer_.flush(); }

 private:
  robot_log::Writer writer_;
  RobotId robot_;
  shell::SharedSteps* steps_;
};

}  // namespace swarm::agent
