// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "robot_agent/agent.hpp"
#include "robot_agent/loop/pose_check.hpp"
#include "robot_agent/loop/robot_log.hpp"
#include "swarm_core/base/prefetch.hpp"
#include "swarm_core/metrics/histogram.hpp"
#include "swarm_link/messages.hpp"
#include "swarmflow/robot/driver.hpp"

namespace swarm::agent {

/// From a new scene until robots are offered the newest plan again, unless a newer one is published
/// before. Planning takes far less.
inline constexpr Duration kReplanTimeout = std::chrono::seconds(5);

/// A plan that a robot is to follow from this tick on.
struct OfferedPlan {
  const FlowPlan& flow;
  std::optional<PlanEntry> entry{};  ///< where the planner has this robot enter; empty: anywhere
  bool again = false;                ///< it was offered before, see Agent::accept_plan()
};

/// The time of a tick and what the mission is at it.
struct RobotTick {
  SteadyTime now;
  UtcTime utc_now;
  Duration lateness{};  ///< actual start minus that of the oldest tick that was due
  Duration period{};    ///< of control
  MissionPhase phase = MissionPhase::kReady;
  bool planner_alive = false;
  bool may_move = true;            ///< see AgentInput
  UtcTime stop_sent{};             ///< stamp of the stop command in force; 0: none
  std::uint32_t plan_version = 0;  ///< of the newest plan; that of new_plan if there is one
  const OfferedPlan* new_plan = nullptr;
  std::optional<PlanTime> plan_time{};              ///< of the plan's clock, if it is known
  const PlannedDensity* planned_density = nullptr;  ///< at that time; null if it is not read
  const SilentRobots* silent = nullptr;             ///< of the process; null: none are kept
};

/// The parts outside of the loop that a step uses. All outlive the step.
struct RobotParts {
  Driver& driver;
  Rng& rng;
  RobotLog& log;
  Histogram* state_ages = nullptr;  ///< of the states used, in µs; null: not measured at this tick
};

/// The control loop of one robot: measure → receive → decide → command → log → publish. The same in
/// a process and in a lock-step simulation, which differ in the clock, the bus and the log that
/// they pass in. Cannot fail: without a plan, a planner or a start command it holds. Once
/// warm it allocates only for notes at changes of mode or plan. One thread at a time.
class RobotLoop {
 public:
  /// \pre the world outlives the loop
  RobotLoop(const World& world, const Shared<AgentOptions>& options, const AgentIdentity& self)
      : agent_(world, options, self), id_(self.robot), pose_check_(options->pose) {}

  /// One tick. The bus is any class with
  ///
  ///   receive(position_m, take)   calls take(const NeighbourReport&, Duration age) for each state
  ///                               that has arrived from another robot near position_m and that
  ///                               passed the gate
  ///   publish(state)              sends a link::RobotStateMessage; not called at every tick
  template <class Bus>
  void step(const RobotTick& tick, const RobotParts& parts, Bus& bus) {
    const Measurement body = measure(tick, parts);
    bus.receive(position_m_, [&](const NeighbourReport& report, Duration age) {
      if (agent_.receive(report, position_m_, age) != NeighbourTable::Outcome::kTaken) return;
      ++states_received_;
      if (parts.state_ages != nullptr) {
        parts.state_ages->add(age / std::chrono::microseconds(1));
      }
    });
    decide(tick, parts, body);
    if (output_.send) bus.publish(next_state(tick.utc_now));
  }

  /// The status that the robot reports to planner and launcher.
  link::RobotStatusMessage status() const;

  /// Whether the last step has something that is reported at once: another mode, or coming to rest
  /// at the goal.
  bool has_updates() const { return has_updates_; }

  /// A fault of the control method, of the position or of the driver's health; empty without one.
  const std::string& fault() const { return fault_; }

  RobotId id() const { return id_; }
  RobotMode mode() const { return output_.mode; }
  bool settled() const { return output_.settled; }
  bool has_route() const { return agent_.has_route(); }
  double lag_s() const { return agent_.lag_s(); }  ///< see Agent
  /// As measured last, or as set by place_at() before the first measurement.
  const Vec2& position_m() const { return position_m_; }
  void place_at(const Vec2& position_m) { position_m_ = position_m; }
  std::uint32_t states_sent() const { return states_sent_; }
  std::uint32_t states_received() const { return states_received_; }

  /// For callers that step many robots in turn: brings what a step reads into the cache, first the
  /// loop itself, then what it points to.
  void prefetch() const {
    agent_.prefetch();
    swarm::prefetch(&id_, sizeof(*this) - sizeof(agent_));
  }
  void prefetch_neighbours() const { agent_.prefetch_neighbours(); }

 private:
  Measurement measure(const RobotTick& tick, const RobotParts& parts);
  void decide(const RobotTick& tick, const RobotParts& parts, const Measurement& body);
  AgentOutput without_position(MissionPhase phase) const;
  void update_fault(const Driver& driver);
  void log_step(const RobotTick& tick, RobotLog& log, const Vec2& true_position_m) const;
  std::uint8_t goal() const;
  link::RobotStateMessage next_state(UtcTime utc_now);

  Agent agent_;
  RobotId id_;
  std::uint32_t ticks_ = 0;
  std::uint32_t late_ticks_ = 0;
  std::uint32_t states_sent_ = 0;  // the sequence number of the last
  std::uint32_t states_received_ = 0;
  bool has_updates_ = false;
  PoseCheck pose_check_;
  CheckedPose pose_;           // of this tick
  bool has_position_ = false;  // there has been one
  bool is_lost_ = false;       // the fault is that there is none
  Vec2 position_m_ = Vec2::Zero();
  AgentOutput output_;
  std::string fault_;
};

}  // namespace swarm::agent
