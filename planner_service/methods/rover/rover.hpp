// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "planner_service/methods/rover/ftmpc.hpp"
#include "planner_service/methods/rover/risk_graph.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/mixture.hpp"

namespace swarm::planner {

/// Parameters of ROVER: its graph, its FTMPC, and the time scale of its steps.
struct RoverOptions {
  RiskGraphOptions graph{};
  FtmpcOptions mpc{};
  double speed_mps = 1.25;      ///< a step lasts as long as its longest leg, in W₂, takes at this
  std::size_t max_steps = 400;  ///< of a whole mission
};

/// One step of the mission: from the current mixture to the next.
struct RoverStep {
  /// Mass that moves from a component of `from` to one of `to`.
  struct Arc {
    std::size_t from = 0;  ///< component of `from`
    std::size_t to = 0;    ///< component of `to`
    double mass = 0.0;     ///< π_k(from, to)
  };
  Mixture from;  ///< the current mixture
  Mixture to;    ///< the next one
  std::vector<Arc> arcs;
  double duration_s = 0.0;  ///< 0 when nothing moves
  /// Largest true GMM-CVaR (11g) over all obstacles, from the mixture itself, by step 1 … h.
  std::vector<double> cvar_m;
  HorizonPlan horizon;
};

/// A whole mission: the flow, and the steps it was made of.
struct RoverMission {
  FlowPlan plan;
  std::vector<RoverStep> steps;
};

/// ROVER: the macroscopic planner of the paper. Made once for a world and a goal, which is the
/// offline stage; then steps, each from where the swarm is.
class Rover {
 public:
  /// Keeps a reference to the world. Errors as of RiskGraph::make(); kInfeasible also when the goal
  /// itself breaks (11f) or (11g).
  static Result<Rover> make(const World& world, const Mixture& goal, const RoverOptions& options);

  /// Plans h steps and takes the first. Remembers its linearisations for the next call, from
  /// wherever that starts: forget() makes it as new. Components of `current` need not be of C. What
  /// carries less than 1e-6 is joined with the rest.
  Result<RoverStep> step(const Mixture& current);

  /// The whole mission from `start`, step by step, as one flow: FlowPlan::sources()[i] is start
  /// component i, sinks()[j] goal component j, with the weights of `goal`, which are otherwise
  /// those of make(). (11g) holds at every step, start included, else kInfeasible names the
  /// parameter to loosen. With FtmpcOptions::soften the start, and the steps until it is satisfied,
  /// may break it: for a swarm that flies already.
  Result<RoverMission> plan(const Mixture& start, const Mixture& goal);
  Result<RoverMission> plan(const Mixture& start) { return plan(start, goal_); }

  void forget();
  const RiskGraph& graph() const { return graph_; }
  const RoverOptions& options() const { return options_; }

 private:
  Rover(RiskGraph graph, const Mixture& goal, const RoverOptions& options);
  Result<std::vector<VertexMass>> locate(const Mixture& current);
  Result<RoverStep> step_from(std::span<const VertexMass> sources);
  bool arrived(std::span<const VertexMass> masses) const;
  Mixture mixture_of(std::span<const VertexMass> masses) const;

  RiskGraph graph_;
  RoverOptions options_;
  Mixture goal_;
  std::vector<double> goal_weights_;
  HorizonMemory memory_;
};

}  // namespace swarm::planner
