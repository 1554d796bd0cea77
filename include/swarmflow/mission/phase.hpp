// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace swarm {

/// Phase of a mission; changed by commands (phase_after()). The numbers are those of the messages.
enum class MissionPhase : std::uint8_t {
  kReady = 0,    ///< not started yet: robots wait at their start positions
  kRunning = 1,  ///< robots follow the plan
  kPaused = 2,   ///< robots hold their positions, the plan's clock is stopped
  kStopped = 3   ///< emergency stop; final
};

/// A command to the whole swarm, from launcher, script or operator.
enum class CommandKind : std::uint8_t {
  kStart = 0,   ///< begins the mission; its stamp is t0 of mission time
  kPause = 1,   ///< holds all robots
  kResume = 2,  ///< continues after a pause
  kStop = 3     ///< emergency stop: zero velocity, for good
};

/// What a robot is doing.
enum class RobotMode : std::uint8_t {
  kWaiting = 0,  ///< no plan yet, or the mission has not started: holds with avoidance on
  kMoving = 1,   ///< follows its route
  kHolding = 2,  ///< planner silent, mission paused or no position: holds with avoidance on
  kArrived = 3,  ///< at its final position, which it keeps with avoidance on
  kStopped = 4,  ///< emergency stop or failed control method, latched: zero velocity
};

/// The phase as files and messages for people name it: "ready", "running", "paused", "stopped".
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

/// The command as a script names it: "start", "pause", "resume", "stop".
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

/// The mode as logs and views name it: "waiting", "moving", "holding", "arrived", "stopped".
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

/// The phase after a command, the same in planner, agents and launcher. A stop is always obeyed; a
/// command that does not apply in a phase (a pause before the start) changes nothing.
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
