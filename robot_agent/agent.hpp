// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "robot_agent/control/attraction.hpp"
#include "robot_agent/control/diffusion_kick.hpp"
#include "robot_agent/control/neighbour_repulsion.hpp"
#include "robot_agent/control/obstacle_repulsion.hpp"
#include "robot_agent/control/pursuit.hpp"
#include "robot_agent/control/route.hpp"
#include "robot_agent/control/safety_filter.hpp"
#include "robot_agent/neighbour_table.hpp"
#include "robot_agent/say_policy.hpp"
#include "swarm_core/base/random.hpp"
#include "swarm_core/mission/mission.hpp"
#include "swarm_core/mission/phase.hpp"

namespace swarm::agent {

struct AgentOptions {
  RobotId robot;
  double share = 0.0;  ///< of the stratified draw, see stratified_share()
  std::uint64_t seed = 0;
  RouteOptions route;
  PursuitOptions pursuit;
  AttractionOptions attraction;
  NeighbourRepulsionOptions neighbour_repulsion;
  ObstacleRepulsionOptions obstacle_repulsion;
  SafetyOptions safety;
  KickOptions kick;
  NeighbourOptions neighbours;
  SayOptions say;
};

/// The options of one robot of a mission.
AgentOptions agent_options(const Mission& mission, RobotId robot, std::uint64_t seed);

/// Where this robot enters a plan that was made in mid-flight.
struct PlanEntry {
  std::uint32_t source = 0;  ///< index into FlowPlan::sources()
  double share = 0.0;        ///< in [0, 1), for the draws at the splits behind it
};

struct AgentInput {
  SteadyTime now;
  Vec2 position_m = Vec2::Zero();  ///< measured
  MissionPhase phase = MissionPhase::kReady;
  bool planner_alive = false;
};

struct AgentOutput {
  Vec2 velocity_mps = Vec2::Zero();  ///< to command; valid for two control periods
  RobotMode mode = RobotMode::kWaiting;
  bool say = false;          ///< tell the neighbours the new state now
  bool settled = false;      ///< arrived and at rest
  double remaining_m = 0.0;  ///< of the own way
  double nearest_gap_m =
      0.0;  ///< to the nearest believed neighbour, surface to surface; +∞ if none
  std::uint16_t neighbours = 0;
};

/// One robot: turns the flow, the map and what it hears of its neighbours into its velocity, alone.
/// A pure function of its inputs and its seed; the control loop cannot fail, it holds. tick() does
/// not allocate once warm.
class Agent {
 public:
  /// \pre the world outlives the agent
  Agent(const World& world, const AgentOptions& options);

  /// Takes a plan. One with the digest of the present one changes nothing, so a restarted planner
  /// that publishes the same flow does not make robots start over. Without an entry a robot finds
  /// its own way into it.
  void accept_plan(const FlowPlan& plan, const Vec2& position_m,
                   std::optional<PlanEntry> entry = std::nullopt);

  NeighbourTable::Outcome hear(const NeighbourReport& report, const Vec2& own_position_m) {
    return neighbours_.take(report, own_position_m);
  }

  AgentOutput tick(const AgentInput& input);

  bool has_route() const { return route_.has_value(); }
  /// Index of the goal (sink of the plan) this robot goes to. \pre has_route()
  std::uint32_t goal() const { return route_->sink; }
  /// Where the present way begins. \pre has_route()
  Vec2 way_begin_m() const { return route_->path.at(0.0); }
  std::uint32_t kicks() const { return kick_.kicks(); }

 private:
  RobotMode decide_mode(const AgentInput& input) const;
  bool has_arrived(const AgentInput& input);
  Vec2 wish(const AgentInput& input, RobotMode mode);

  const World& world_;
  AgentOptions options_;
  Rng rng_;
  NeighbourTable neighbours_;
  SafetyFilter filter_;
  DiffusionKick kick_;
  SayPolicy say_;
  std::optional<Route> route_;
  std::uint64_t plan_digest_ = 0;
  Pursuit pursuit_;
  bool arrived_ = false;
  bool moved_ = false;
  SteadyTime progress_at_;
  double best_remaining_m_ = 0.0;
};

}  // namespace swarm::agent
