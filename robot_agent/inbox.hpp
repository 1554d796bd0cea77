// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "robot_agent/agent.hpp"
#include "robot_agent/mission_watch.hpp"
#include "robot_agent/neighbours/neighbour_table.hpp"
#include "robot_agent/neighbours/received_cells.hpp"
#include "robot_agent/plan_time_watch.hpp"
#include "swarm_core/metrics/histogram.hpp"
#include "swarm_link/channels/state_channel.hpp"
#include "swarm_link/gate/gate.hpp"
#include "swarm_link/gate/waiting_plan.hpp"

namespace swarm::agent {

using link::EchoGuard;

/// The readers of the topics that every agent process subscribes to.
struct Readers {
  link::ReaderPtr<link::PlanMessage> plan;
  link::ReaderPtr<link::SceneMessage> scene;
  link::ReaderPtr<link::HeartbeatMessage> heartbeat;
  link::ReaderPtr<link::CommandMessage> command;
};

/// A plan that passed the gate.
struct NewPlan {
  FlowPlan flow;
  std::vector<link::PlanEntryMessage> entries;  ///< by robot id; empty in a mission's first plan

  /// Where the plan has this robot enter; empty if the robot chooses.
  std::optional<PlanEntry> entry_of(RobotId robot) const {
    if (robot.value() >= entries.size()) return std::nullopt;
    const link::PlanEntryMessage& entry = entries[robot.value()];
    if (entry.source == link::kAnySource) return std::nullopt;
    return PlanEntry{entry.source, entry.share / 65536.0};
  }
};

/// What an agent process receives: takes everything that arrived, has the gate check it, and hands
/// on domain objects.
class Inbox {
 public:
  /// `communication_radius_m`: the largest of the robots of the process.
  Inbox(Readers readers, link::StateChannel& states, const link::WireLimits& limits,
        const MissionWatch& mission, Duration planner_silence, double communication_radius_m);

  /// Takes what arrived. `own(id)` names the guard of a robot of this process, or nullptr. Robots
  /// of one process receive each other over the bus as any others; a robot skips its own echo.
  template <class OwnGuard>
  void receive(SteadyTime steady_now, UtcTime utc_now, OwnGuard own) {
    receive_fixed_topics(steady_now, utc_now);
    begin_states();
    for (const link::CellStatesMessage& batch : batches_) {
      if (!gate_.batch(batch)) continue;
      for (const link::RobotStateMessage& state : batch.states) {
        receive_state(state, steady_now, utc_now, own(RobotId(state.robot_id)));
      }
    }
    received_before_ = steady_now;
    received_cells_.sort(received_);
  }

  /// A command that arrived by another path than the topic: the stop channel.
  void receive(const link::CommandMessage& command, UtcTime utc_now);

  /// How many datagrams of the stop channel could not be decoded, and how many beats of the
  /// launcher were refused (Whereabouts), both since the start.
  void count_stop_channel(std::uint64_t undecodable, std::uint64_t refused_beats) {
    undecodable_stops_ = undecodable;
    gate_.set_refused_beats(refused_beats);
  }

  /// The states received at the last tick, in the order of their arrival.
  std::span<const ReceivedState> states() const { return received_; }
  /// The same, to be visited by position.
  const ReceivedCells& received() const { return received_cells_; }

  /// The newest plan, once, when one arrived.
  std::optional<NewPlan> take_plan() { return std::exchange(new_plan_, std::nullopt); }
  /// The newest scene, once, when one arrived.
  std::optional<Scene> take_scene() { return std::exchange(new_scene_, std::nullopt); }
  std::uint64_t plan_epoch() const { return plan_epoch_; }
  std::uint32_t plan_version() const { return plan_version_; }
  std::uint64_t plan_scene_version() const { return plan_scene_version_; }

  const MissionWatch& mission() const { return mission_; }
  /// Plan time of the newest plan; empty until a heartbeat of that plan is received.
  std::optional<PlanTime> plan_time(SteadyTime now) { return plan_time_.at(now); }
  std::int64_t stop_stamp_utc_ns() const { return stop_stamp_utc_ns_; }
  /// Of the newest command that the robots obey; 0: none yet.
  std::uint64_t command_id() const { return command_id_; }

  /// A robot of this process under whose id a state arrived that it did not publish, made after
  /// this process began to receive; of several the first.
  std::optional<RobotId> duplicate_id() const { return duplicate_id_; }

  const link::RefusalCounters& refused() const { return gate_.refused(); }
  std::uint32_t skewed() const {
    return skewed_;
  }  ///< states whose clock differs by more than the warning

 private:
  void receive_fixed_topics(SteadyTime now, UtcTime utc_now);
  void receive_plans(UtcTime utc_now);
  void receive_plan(link::PlanMessage& message, UtcTime utc_now);
  void take_waiting_plan(UtcTime utc_now);
  void receive_scenes(UtcTime utc_now);
  void receive_heartbeats(SteadyTime now, UtcTime utc_now);
  void receive_commands(UtcTime utc_now);
  void begin_states();
  void receive_state(const link::RobotStateMessage& state, SteadyTime steady_now, UtcTime utc_now,
                     const EchoGuard* own);
  void note_duplicate(const link::RobotStateMessage& state, UtcTime utc_now);

  Readers readers_;
  link::StateChannel& states_;
  link::WireLimits limits_;
  MissionWatch mission_;
  PlanTimeWatch plan_time_;
  std::uint64_t plan_digest_ = 0;
  link::Gate gate_;
  std::optional<NewPlan> new_plan_;
  link::WaitingPlan waiting_plan_;
  std::optional<Scene> new_scene_;
  std::uint64_t plan_scene_version_ = 0;
  std::uint64_t plan_epoch_ = 0;
  std::uint32_t plan_version_ = 0;
  std::int64_t stop_stamp_utc_ns_ = 0;
  std::uint64_t command_id_ = 0;
  std::uint32_t skewed_ = 0;
  std::uint64_t undecodable_stops_ = 0;
  std::optional<UtcTime> began_;  ///< of the first call of receive()
  std::optional<RobotId> duplicate_id_;
  std::optional<SteadyTime> received_before_;
  std::vector<ReceivedState> received_;
  ReceivedCells received_cells_;
  std::vector<link::PlanMessage> plans_;
  std::vector<link::SceneMessage> scenes_;
  std::vector<link::HeartbeatMessage> heartbeats_;
  std::vector<link::CommandMessage> commands_;
  std::vector<link::CellStatesMessage> batches_;
};

}  // namespace swarm::agent
