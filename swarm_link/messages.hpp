// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "swarm_link/fields.hpp"
#include "swarm_link/plan_message.hpp"
#include "swarm_link/scene_message.hpp"
#include "swarm_link/schema_version.hpp"
#include "swarmflow/mission/phase.hpp"

/// The messages of the bus, as plain structs without vendor types: field for field the structs of
/// idl/swarm.idl, which documents them, each with the list of its fields (fields.hpp). Values may
/// be anything a peer sent; they are used only after they have passed the Gate
/// (swarm_link/gate/gate.hpp).
namespace swarm::link {

/// Bounds of sequences and texts, as in the IDL.
inline constexpr std::size_t kMaxCellStates = 256;
inline constexpr std::size_t kMaxStatusRobots = 100;
inline constexpr std::size_t kMaxRefusalReasons = 16;
inline constexpr std::size_t kMaxHistogramBins = 464;
inline constexpr std::size_t kMaxEventCode = 64;
inline constexpr std::size_t kMaxEventText = 512;

/// Event::source of processes that are not robots.
inline constexpr std::uint32_t kPlannerSource = 0xFFFF'FFFF;
inline constexpr std::uint32_t kLauncherSource = 0xFFFF'FFFE;

using swarm::CommandKind;
using swarm::MissionPhase;
using swarm::RobotMode;

/// Severity of an event.
enum class Severity : std::uint8_t { kInfo = 0, kWarning = 1, kError = 2 };

/// The planner's sign of life and the clock of the plan: at `stamp_utc_ns` plan `version` is at
/// `plan_time_s` and advances by `plan_rate` seconds of plan time per second.
struct HeartbeatMessage {
  std::uint16_t schema_version = kSchemaVersion;  ///< of the IDL the sender was built with
  MissionPhase phase = MissionPhase::kReady;      ///< of the mission, as the planner has it
  std::uint32_t version = 0;                      ///< of the plan
  std::uint64_t epoch = 0;                        ///< of its planner, UTC [ns] of its start
  std::uint64_t sequence_number = 0;              ///< from 1 in each epoch
  std::int64_t stamp_utc_ns = 0;
  double mission_time_s = 0;  ///< since the start of the mission
  double plan_time_s = 0;
  double plan_rate = 0;  ///< in [0, 1]
  bool operator==(const HeartbeatMessage&) const = default;

  using M = HeartbeatMessage;
  static constexpr std::string_view kIdlName = "Heartbeat";
  static constexpr FieldList<&M::schema_version, &M::phase, &M::version, &M::epoch,
                             &M::sequence_number, &M::stamp_utc_ns, &M::mission_time_s,
                             &M::plan_time_s, &M::plan_rate>
      kFields{};
};

/// State of one robot, at control rate; sent in batches per cell.
struct RobotStateMessage {
  std::uint32_t robot_id = 0;                       ///< below the number of robots
  std::uint32_t sequence_number = 0;                ///< consecutive
  std::int64_t stamp_utc_ns = 0;                    ///< time of position and velocity
  double x_m = 0, y_m = 0, vx_mps = 0, vy_mps = 0;  ///< in the world frame, ENU
  RobotMode mode = RobotMode::kWaiting;
  bool operator==(const RobotStateMessage&) const = default;

  using M = RobotStateMessage;
  static constexpr std::string_view kIdlName = "RobotState";
  static constexpr FieldList<&M::robot_id, &M::sequence_number, &M::stamp_utc_ns, &M::x_m, &M::y_m,
                             &M::vx_mps, &M::vy_mps, &M::mode>
      kFields{};
};

/// States of the robots of one process that are in one cell.
struct CellStatesMessage {
  std::uint16_t schema_version = kSchemaVersion;
  std::int32_t cell_x = 0, cell_y = 0;
  std::vector<RobotStateMessage> states{};  ///< several batches if there are more
  bool operator==(const CellStatesMessage&) const = default;

  using M = CellStatesMessage;
  static constexpr std::string_view kIdlName = "CellStates";
  static constexpr FieldList<&M::schema_version, &M::cell_x, &M::cell_y,
                             up_to(kMaxCellStates, &M::states)>
      kFields{};
};

/// A command of the user or of the mission script. A repeated stop is the same message again.
struct CommandMessage {
  std::uint16_t schema_version = kSchemaVersion;
  CommandKind kind = CommandKind::kStart;
  std::uint64_t command_id = 0;  ///< UTC [ns], so it increases
  std::int64_t stamp_utc_ns = 0;
  bool operator==(const CommandMessage&) const = default;

  using M = CommandMessage;
  static constexpr std::string_view kIdlName = "Command";
  static constexpr FieldList<&M::schema_version, &M::kind, &M::command_id, &M::stamp_utc_ns>
      kFields{};
};

/// A bin of a Histogram that is not empty.
struct HistogramBinMessage {
  std::uint16_t bin = 0;  ///< index, see Histogram
  std::uint32_t count = 0;
  bool operator==(const HistogramBinMessage&) const = default;

  using M = HistogramBinMessage;
  static constexpr std::string_view kIdlName = "HistogramBin";
  static constexpr FieldList<&M::bin, &M::count> kFields{};
};

/// Health of one robot, within a StatusMessage.
struct RobotStatusMessage {
  std::uint32_t robot_id = 0;
  RobotMode mode = RobotMode::kWaiting;
  bool arrived = false;  ///< reached its goal
  bool settled = false;  ///< arrived and at rest
  double x_m = 0, y_m = 0;
  double remaining_m = 0;                   ///< path length to the goal
  double lag_s = 0;                         ///< plan time behind its reference position
  double nearest_gap_m = 0;                 ///< to the nearest neighbour, surface to surface
  std::uint32_t neighbours_heard = 0;       ///< neighbours whose states it receives
  std::uint32_t ticks = 0, late_ticks = 0;  ///< control periods since its start
  std::uint32_t states_sent = 0, states_received = 0;
  bool operator==(const RobotStatusMessage&) const = default;

  using M = RobotStatusMessage;
  static constexpr std::string_view kIdlName = "RobotStatus";
  static constexpr FieldList<&M::robot_id, &M::mode, &M::arrived, &M::settled, &M::x_m, &M::y_m,
                             &M::remaining_m, &M::lag_s, &M::nearest_gap_m, &M::neighbours_heard,
                             &M::ticks, &M::late_ticks, &M::states_sent, &M::states_received>
      kFields{};
};

/// Health of a group of robots of one process, about once per second and at every change of mode.
struct StatusMessage {
  std::uint32_t first_robot_id = 0;  ///< the key: names the group
  std::uint16_t schema_version = kSchemaVersion;
  std::uint32_t process_id = 0;    ///< of the operating system
  std::uint32_t plan_version = 0;  ///< of the plan it follows; 0: none
  std::uint64_t plan_epoch = 0;
  std::uint64_t plan_scene_version = 0;  ///< scene that the plan was made for
  std::uint64_t command_id = 0;          ///< of the newest command that it obeys; 0: none yet
  std::int64_t stamp_utc_ns = 0;
  double plan_time_s = 0;                        ///< of the plan's clock, as the process has it
  std::vector<RobotStatusMessage> robots{};      ///< the group, by id
  std::vector<std::uint32_t> refused{};          ///< by RefusalReason
  std::vector<HistogramBinMessage> state_age{};  ///< bins of Histogram that are not empty
  bool operator==(const StatusMessage&) const = default;

  using M = StatusMessage;
  static constexpr std::string_view kIdlName = "Status";
  static constexpr bool kKeyed = true;
  static constexpr FieldList<
      &M::first_robot_id, &M::schema_version, &M::process_id, &M::plan_version, &M::plan_epoch,
      &M::plan_scene_version, &M::command_id, &M::stamp_utc_ns, &M::plan_time_s,
      up_to(kMaxStatusRobots, &M::robots), up_to(kMaxRefusalReasons, &M::refused),
      up_to(kMaxHistogramBins, &M::state_age)>
      kFields{};
};

/// A notable event, for logs and people.
struct EventMessage {
  std::uint16_t schema_version = kSchemaVersion;
  Severity severity = Severity::kInfo;
  std::uint32_t source = 0;  ///< robot id, or one of the constants above
  std::int64_t stamp_utc_ns = 0;
  std::string code{};  ///< stable, machine-readable, kebab-case; at most 64 characters
  std::string text{};  ///< readable text; at most 512 characters
  bool operator==(const EventMessage&) const = default;

  using M = EventMessage;
  static constexpr std::string_view kIdlName = "Event";
  static constexpr FieldList<&M::schema_version, &M::severity, &M::source, &M::stamp_utc_ns,
                             up_to(kMaxEventCode, &M::code), up_to(kMaxEventText, &M::text)>
      kFields{};
};

}  // namespace swarm::link
