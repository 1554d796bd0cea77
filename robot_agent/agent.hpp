// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "robot_agent/agent_options.hpp"
#include "robot_agent/neighbours/neighbour_table.hpp"
#include "robot_agent/safety/guarded_method.hpp"
#include "robot_agent/safety/safety_filter.hpp"
#include "robot_agent/send_policy.hpp"
#include "swarm_core/base/shared.hpp"
#include "swarmflow/core/random.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/mission/phase.hpp"
#include "swarmflow/robot/route.hpp"

namespace swarm::agent {

/// What distinguishes a robot from others with the same body.
struct AgentIdentity {
  RobotId robot;
  double share = 0.0;     ///< of the stratified draw, see stratified_share()
  bool underway = false;  ///< respawned: it may be anywhere along its path
};

/// The identity of a robot at the beginning of a mission.
AgentIdentity agent_identity(const Mission& mission, RobotId robot);

/// The random numbers of a robot, a function of the run's seed and its id.
inline Rng agent_rng(RobotId robot, std::uint64_t seed) {
  return Rng(mix_seed(seed, robot.value()));
}

/// Where this robot enters a plan that was made in mid-flight.
struct PlanEntry {
  std::uint32_t source = 0;  ///< index into FlowPlan::sources()
  double share = 0.0;        ///< in [0, 1), for the draws at the splits behind it
};

/// What a robot knows at a tick.
struct AgentInput {
  SteadyTime now;
  Vec2 position_m = Vec2::Zero();  ///< measured
  MissionPhase phase = MissionPhase::kReady;
  bool planner_alive = false;
  bool may_move = true;  ///< otherwise it stands at zero velocity, without avoidance
  /// Measured, of a body that does not have a commanded velocity at once.
  std::optional<Vec2> velocity_mps{};
  std::optional<PlanTime> plan_time{};  ///< of the plan accepted last; empty: no clock is known
  const PlannedDensity* planned_density = nullptr;  ///< then; read if density_push_mps > 0
  const SilentRobots* silent = nullptr;             ///< of the process; null: none are kept
};

/// What a robot decides at a tick.
struct AgentOutput {
  Vec2 velocity_mps = Vec2::Zero();  ///< to command; valid for two control periods
  Vec2 reported_mps = Vec2::Zero();  ///< the velocity to publish
  RobotMode mode = RobotMode::kWaiting;
  bool send = false;         ///< publish the new state now
  bool settled = false;      ///< arrived and at rest
  double remaining_m = 0.0;  ///< left of the own path
  double nearest_gap_m =
      0.0;  ///< to the nearest estimated neighbour, surface to surface; +∞ if none
  std::uint16_t neighbours = 0;
  std::optional<TimeTracking>
      tracking{};  ///< empty for a robot that does not keep the plan's times
  std::span<const Neighbour> estimated{};  ///< those within reach; valid until the next tick
};

/// One robot: computes its velocity from the flow, the map and the states received from its
/// neighbours alone. A pure function of its inputs and random numbers. tick() cannot fail: a robot
/// that cannot go on holds. It does not allocate once warm.
class Agent {
 public:
  /// \pre the world outlives the agent
  Agent(const World& world, Shared<AgentOptions> options, const AgentIdentity& self);

  /// Takes a plan. One with the digest of the present one changes nothing, so a restarted planner
  /// that publishes the same flow does not make robots start over, unless the body of a dead robot
  /// has come to lie on the rest of the path: then the robot finds another path in the same plan.
  /// Without an entry a robot finds its own path into it, in space and, with the plan's time, in
  /// time. Returns whether it follows another path now.
  bool accept_plan(const FlowPlan& plan, const Vec2& position_m,
                   std::optional<PlanEntry> entry = std::nullopt,
                   std::optional<double> plan_time_s = std::nullopt);

  /// Takes a neighbour's state that was `late` on receipt.
  NeighbourTable::Outcome receive(const NeighbourReport& report, const Vec2& own_position_m,
                                  Duration late = {}) {
    return neighbours_.take(report, own_position_m, late);
  }

  /// One control period. \pre ascending times
  AgentOutput tick(const AgentInput& input, Rng& rng);

  /// For a loop that ticks many robots in turn: bring what a tick reads into the cache, first the
  /// agent itself, then what it points to.
  void prefetch() const { swarm::prefetch(this, sizeof(*this) - sizeof(followed_route_)); }
  void prefetch_neighbours() const { neighbours_.prefetch(); }

  bool has_route() const { return has_route_; }
  /// Index of the goal (sink of the plan) this robot is at or goes to. \pre has_route()
  std::uint32_t goal(const Vec2& position_m) const { return method_.goal(position_m); }
  /// Where the present path begins. \pre has_route()
  const Vec2& route_begin_m() const { return followed_route_.path.vertices_m().front(); }
  /// Plan time by which it is behind its reference position; negative if ahead; 0 once arrived.
  double lag_s() const { return has_route_ && !arrived_ ? method_.lag_s() : 0.0; }
  /// Why the control method is not called any more; empty while it works. A robot without one
  /// stops.
  const std::string& control_fault() const { return method_.fault(); }
  /// How often it freed itself from a deadlock.
  std::uint32_t escapes() const { return method_.escapes(); }

 private:
  bool is_path_blocked() const;
  void keep_slot(Route& route, const Vec2& position_m) const;
  RobotMode decide_mode(const AgentInput& input) const;
  Vec2 filtered_velocity(const ControlView& view, const AgentOutput& out, Rng& rng);

  const World* world_;
  Shared<AgentOptions> options_;
  double mean_share_;  // of a tick, in mean_mps_
  NeighbourTable neighbours_;
  SafetyFilter filter_;
  SendPolicy send_policy_;
  GuardedMethod method_;
  Vec2 mean_mps_ = Vec2::Zero();  // of the commanded velocity
  bool has_route_ = false;
  bool arrived_ = false;
  bool moved_ = false;
  /// What a new plan is compared with. Rarely read, so it comes last and is not prefetched.
  struct FollowedRoute {
    double share;
    std::uint64_t plan_digest = 0;
    Polyline path{};
    double end_s = 0.0;  // of the schedule
    Gaussian goal{};
  };
  FollowedRoute followed_route_;
};

}  // namespace swarm::agent
