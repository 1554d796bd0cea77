// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "robot_agent/loop/robot_log.hpp"
#include "swarm_core/app/file_thread.hpp"
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

/// A robot's log as a file; records that find no room are dropped and counted.
class LogFile final : public RobotLog {
 public:
  explicit LogFile(robot_log::Writer writer) : writer_(std::move(writer)) {}

  void append(const robot_log::Step& step) override { writer_.append(step); }
  void append(const robot_log::Estimate& estimate) override { writer_.append(estimate); }
  void append(robot_log::Note note) override { writer_.append(std::move(note)); }
  void append(const robot_log::LinkStats& stats) { writer_.append(stats); }
  /// Hands over what waits for a chunk to be full.
  void flush() { writer_.flush(); }

 private:
  robot_log::Writer writer_;
};

}  // namespace swarm::agent
