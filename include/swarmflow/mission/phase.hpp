// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace swarm {

/// Where a mission stands. Moved by commands; kStopped is final.
enum class MissionPhase : std::uint8_t { kReady = 0, kRunning = 1, kPaused = 2, kStopped = 3 };

enum class CommandKind : std::uint8_t { kStart = 0, kPause = 1, kResume = 2, kStop = 3 };

/// What a robot is doing.
enum class RobotMode : std::uint8_t {
  kWaiting = 0,  ///< no plan yet, or the mission has not started: holds with avoidance on
  kMoving = 1,
  kHolding = 2,  ///< planner silent or mission paused: holds with avoidance on
  kArrived = 3,
  kStopped = 4,  ///< emergency stop, latched: zero velocity
};

constexpr std::string_view to_string(MissionPhase phase) {
  switch (phase) {
    case MissionPhase::kReady:
      return "ready";
    case MissionPhase::kRunning:
      return "running";
    case MissionPhase::kPaused:
      return "paused";
    case MissionPhase::kStopped:
      return "stopped";
  }
  return "unknown";
}

constexpr std::string_view to_string(CommandKind kind) {
  switch (kind) {
    case CommandKind::kStart:
      return "start";
    case CommandKind::kPause:
      return "pause";
    case CommandKind::kResume:
      return "resume";
    case CommandKind::kStop:
      return "stop";
  }
  return "unknown";
}

constexpr std::string_view to_string(RobotMode mode) {
  switch (mode) {
    case RobotMode::kWaiting:
      return "waiting";
    case RobotMode::kMoving:
      return "moving";
    case RobotMode::kHolding:
      return "holding";
    case RobotMode::kArrived:
      return "arrived";
    case RobotMode::kStopped:
      return "stopped";
  }
  return "unknown";
}

/// The phase after a command, for planner, agents and launcher alike. A stop always holds; what
/// makes no sense in a phase (pausing before the start) changes nothing.
constexpr MissionPhase phase_after(MissionPhase phase, CommandKind kind) {
  if (phase == MissionPhase::kStopped || kind == CommandKind::kStop) return MissionPhase::kStopped;
  switch (kind) {
    case CommandKind::kStart:
      return phase == MissionPhase::kReady ? MissionPhase::kRunning : phase;
    case CommandKind::kPause:
      return phase == MissionPhase::kRunning ? MissionPhase::kPaused : phase;
    case CommandKind::kResume:
      return phase == MissionPhase::kPaused ? MissionPhase::kRunning : phase;
    case CommandKind::kStop:
      break;
  }
  return phase;
}

}  // namespace swarm
