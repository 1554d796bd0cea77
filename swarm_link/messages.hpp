// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "swarmflow/mission/phase.hpp"

/// What travels on the bus, as plain structs without any vendor's types: field for field the
/// structs of idl/swarm.idl, which documents them. Numbers here may be anything a peer sent; they
/// are used only once they have passed the Gate (swarm_link/gate/gate.hpp).
namespace swarm::link {

inline constexpr std::uint16_t kSchemaVersion = 4;
inline constexpr std::size_t kMaxCellStates = 256;

/// Event::source of whoever is not a robot.
inline constexpr std::uint32_t kPlannerSource = 0xFFFF'FFFF;
inline constexpr std::uint32_t kLauncherSource = 0xFFFF'FFFE;
/// SceneObstacleMessage::owner_robot_id of what is no robot's body.
inline constexpr std::uint32_t kNoRobot = 0xFFFF'FFFF;

using swarm::CommandKind;
using swarm::MissionPhase;
using swarm::RobotMode;

enum class Severity : std::uint8_t { kInfo = 0, kWarning = 1, kError = 2 };

struct PlanNodeMessage {
  double mean_x_m = 0, mean_y_m = 0;
  double covariance_xx_m2 = 0, covariance_xy_m2 = 0, covariance_yy_m2 = 0;
  double time_s = 0, mass = 0;
  bool operator==(const PlanNodeMessage&) const = default;
};

struct PlanLegMessage {
  std::uint32_t from_node = 0, to_node = 0;
  double mass = 0;
  bool operator==(const PlanLegMessage&) const = default;
};

struct PlanEntryMessage {
  std::uint16_t source = 0, share = 0;
  bool operator==(const PlanEntryMessage&) const = default;
};

struct PlanMessage {
  std::uint16_t schema_version = kSchemaVersion;
  std::uint32_t version = 0;
  std::uint64_t epoch = 0;
  std::uint64_t scene_version = 0;
  std::int64_t t0_utc_ns = 0;
  double excess_m = 0;
  std::vector<PlanNodeMessage> nodes{};
  std::vector<PlanLegMessage> legs{};
  std::vector<PlanEntryMessage> entries{};
  bool operator==(const PlanMessage&) const = default;
};

struct PointMessage {
  double x_m = 0, y_m = 0;
  bool operator==(const PointMessage&) const = default;
};

struct SceneObstacleMessage {
  std::uint32_t obstacle_id = 0;
  std::uint32_t owner_robot_id = kNoRobot;
  std::uint32_t vertices = 0;
  PointMessage center{};
  double radius_m = 0;
  double velocity_x_mps = 0, velocity_y_mps = 0;
  std::int64_t moving_from_utc_ns = 0, moving_until_utc_ns = 0;
  bool operator==(const SceneObstacleMessage&) const = default;
};

struct GoalComponentMessage {
  double mean_x_m = 0, mean_y_m = 0;
  double covariance_xx_m2 = 0, covariance_xy_m2 = 0, covariance_yy_m2 = 0;
  double weight = 0;
  bool operator==(const GoalComponentMessage&) const = default;
};

struct SceneMessage {
  std::uint16_t schema_version = kSchemaVersion;
  std::uint64_t version = 0;
  double risk_alpha = 0;
  std::uint32_t next_id = 0;
  std::vector<std::uint32_t> removed{};
  std::vector<SceneObstacleMessage> obstacles{};
  std::vector<PointMessage> vertices{};
  std::vector<GoalComponentMessage> goal{};
  bool operator==(const SceneMessage&) const = default;
};

struct HeartbeatMessage {
  std::uint16_t schema_version = kSchemaVersion;
  MissionPhase phase = MissionPhase::kReady;
  std::uint32_t version = 0;
  std::uint64_t epoch = 0;
  std::uint64_t sequence_number = 0;
  std::int64_t stamp_utc_ns = 0;
  double mission_time_s = 0;
  double plan_time_s = 0;
  double plan_rate = 0;
  bool operator==(const HeartbeatMessage&) const = default;
};

struct RobotStateMessage {
  std::uint32_t robot_id = 0;
  std::uint32_t sequence_number = 0;
  std::int64_t stamp_utc_ns = 0;
  double x_m = 0, y_m = 0, vx_mps = 0, vy_mps = 0;
  RobotMode mode = RobotMode::kWaiting;
  bool operator==(const RobotStateMessage&) const = default;
};

struct CellStatesMessage {
  std::uint16_t schema_version = kSchemaVersion;
  std::int32_t cell_x = 0, cell_y = 0;
  std::vector<RobotStateMessage> states{};
  bool operator==(const CellStatesMessage&) const = default;
};

struct CommandMessage {
  std::uint16_t schema_version = kSchemaVersion;
  CommandKind kind = CommandKind::kStart;
  std::uint64_t command_id = 0;
  std::int64_t stamp_utc_ns = 0;
  bool operator==(const CommandMessage&) const = default;
};

struct HistogramBinMessage {
  std::uint16_t bin = 0;
  std::uint32_t count = 0;
  bool operator==(const HistogramBinMessage&) const = default;
};

struct RobotStatusMessage {
  std::uint32_t robot_id = 0;
  RobotMode mode = RobotMode::kWaiting;
  bool arrived = false;
  bool settled = false;
  double x_m = 0, y_m = 0;
  double remaining_m = 0;
  double lag_s = 0;
  double nearest_gap_m = 0;
  std::uint32_t neighbours_heard = 0;
  std::uint32_t ticks = 0, late_ticks = 0;
  std::uint32_t states_sent = 0, states_received = 0;
  bool operator==(const RobotStatusMessage&) const = default;
};

struct StatusMessage {
  std::uint32_t first_robot_id = 0;
  std::uint16_t schema_version = kSchemaVersion;
  std::uint32_t process_id = 0;
  std::uint32_t plan_version = 0;
  std::uint64_t plan_epoch = 0;
  std::uint64_t plan_scene_version = 0;
  std::int64_t stamp_utc_ns = 0;
  double plan_time_s = 0;
  std::vector<RobotStatusMessage> robots{};
  std::vector<std::uint32_t> refused{};          ///< by RefusalReason
  std::vector<HistogramBinMessage> state_age{};  ///< bins of Histogram that are not empty
  bool operator==(const StatusMessage&) const = default;
};

struct EventMessage {
  std::uint16_t schema_version = kSchemaVersion;
  Severity severity = Severity::kInfo;
  std::uint32_t source = 0;
  std::int64_t stamp_utc_ns = 0;
  std::string code{};  ///< stable, machine-readable, kebab-case; at most 64 characters
  std::string text{};  ///< for people; at most 512 characters
  bool operator==(const EventMessage&) const = default;
};

}  // namespace swarm::link
