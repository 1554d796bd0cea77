// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "swarm_core/metrics/histogram.hpp"
#include "swarm_link/stream_meter.hpp"
#include "swarm_monitor/audit/recorded_run.hpp"
#include "swarm_monitor/observe/bus_reader.hpp"
#include "swarm_monitor/recording/bus_tap.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/mission/scene.hpp"

namespace swarm::monitor {

/// State of a swarm in progress, from its bus alone. Pure: samples and time are arguments.
class SwarmState final : private Observer {
 public:
  SwarmState(const Mission& mission, link::Stamps stamps);
  SwarmState(const SwarmState&) = delete;
  SwarmState& operator=(const SwarmState&) = delete;

  /// Decodes and checks a sample and updates the state by it.
  void take(const TappedSample& sample) { reader_.take(sample); }

  /// The newest state and status of one robot.
  struct Robot {
    bool was_received = false;
    bool arrived = false;
    UtcTime received{};  ///< its last state or status
    UtcTime moved{};     ///< its last state
    Vec2 position_m = Vec2::Zero();
    Vec2 velocity_mps = Vec2::Zero();
    RobotMode mode = RobotMode::kWaiting;
    double nearest_gap_m = std::numeric_limits<double>::infinity();
    std::uint32_t neighbours = 0;
    std::uint32_t ticks = 0, late_ticks = 0;
  };
  const std::vector<Robot>& robots() const { return robots_; }

  /// Position of a robot at `now`: extrapolated from its last state, as its neighbours do.
  Vec2 position_of(const Robot& robot, UtcTime now) const;
  /// Whether a robot that was received before has been silent for three seconds.
  bool is_lost(const Robot& robot, UtcTime now) const;

  /// Numbers of robots, and the smallest gap that any of them reported [m].
  struct Counts {
    std::uint32_t received = 0, moving = 0, arrived = 0, lost = 0;
    double nearest_gap_m = 0.0;  ///< ∞ without a status
  };
  Counts counts(UtcTime now) const;

  MissionPhase phase() const { return phase_; }
  /// Mission time at `now` [s], extrapolated from the last heartbeat while the mission runs.
  double mission_time_s(UtcTime now) const;
  /// Plan time τ at `now`; the mixture that the swarm is to form is that of the plan at τ.
  double plan_time_s(UtcTime now) const;
  /// Seconds of plan time per second; 0 in a pause.
  double plan_rate() const { return plan_rate_; }
  const std::optional<FlowPlan>& plan() const { return plan_; }
  std::uint32_t plan_version() const { return plan_version_; }
  /// Largest constraint violation that a received plan reported.
  double plan_excess_m() const { return plan_excess_m_; }
  const Scene& scene() const { return scene_; }
  /// Grows with every change of plan or scene.
  std::uint64_t version() const { return version_; }
  const std::vector<RunEvent>& events() const { return events_; }  ///< times since begin()
  std::optional<UtcTime> begin() const { return begin_; }          ///< first state received
  /// Statistics of the received states: losses, duplicates, latency.
  const link::StreamMeter& meter() const { return meter_; }
  link::StreamMeter& meter() { return meter_; }
  const link::RefusalCounters& refused() const { return reader_.refused(); }

 private:
  void on_state(const ObservedState& state) override;
  void on_status(const ObservedStatus& status) override;
  void on_plan(const ObservedPlan& plan) override;
  void on_scene(const Scene& scene) override;
  void on_clock(const ObservedClock& clock) override;
  void on_event(const ObservedEvent& event) override;

  BusReader reader_;
  std::vector<Robot> robots_;
  std::optional<FlowPlan> plan_;
  std::uint32_t plan_version_ = 0;
  double plan_excess_m_ = 0.0;
  Scene scene_;
  std::uint64_t version_ = 0;
  MissionPhase phase_ = MissionPhase::kReady;
  double mission_time_s_ = 0.0;
  double plan_time_s_ = 0.0;
  double plan_rate_ = 0.0;
  UtcTime beat_at_{};                  // reception of the last heartbeat
  std::optional<UtcTime> beat_stamp_;  // its own time; empty before the first
  std::vector<RunEvent> events_;
  std::optional<UtcTime> begin_;
  link::StreamMeter meter_;
};

}  // namespace swarm::monitor
