// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "planner_service/methods/rover/horizon_network.hpp"
#include "planner_service/methods/rover/linear_program.hpp"
#include "planner_service/methods/rover/risk_graph.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::planner {

/// Parameters of one FTMPC.
struct FtmpcOptions {
  HorizonCosts costs{};
  /// (11f): robots times the mixture's density at the collocation means stays below this; 0 = off.
  double density_cap_per_m2 = 0.0;
  double robots = 0.0;
  double eta = 1e-5;  ///< of Alg. 1, on ‖F^v − F^{v−1}‖
  int max_iterations = 50;
  /// A swarm that violates a constraint already, and cannot satisfy it within the horizon, gets the
  /// plan with the least excess instead of kInfeasible.
  bool soften = false;
  bool keep_program = false;
};

/// The state that one MPC step passes to the next: the last linearisation point of each risk row,
/// by step, part of it and obstacle, and the arcs of the plan.
class HorizonMemory {
 public:
  HorizonMemory() = default;
  HorizonMemory(std::size_t horizon, std::size_t parts, std::size_t obstacles);

  /// z of (R), NaN where there is none.
  double& from_m(std::size_t step, std::size_t part, std::size_t obstacle) {
    return from_m_[((step - 1) * parts_ + part) * obstacles_ + obstacle];
  }
  /// Arcs that carried mass, as (from, to), by stage.
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>>& arcs() { return arcs_; }

  /// Moves everything one step ahead: values of step p + 1 become those of step p.
  void shift();

 private:
  std::size_t parts_ = 0;
  std::size_t obstacles_ = 0;
  std::vector<double> from_m_;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> arcs_;
};

/// Mass that one stage of the horizon moves along an arc, or keeps at a vertex (from = to).
struct StageFlow {
  std::uint32_t from = 0;  ///< vertices of the RiskGraph
  std::uint32_t to = 0;
  double mass = 0.0;
};

/// The solution of one FTMPC, with the numbers a report needs.
struct HorizonPlan {
  std::vector<std::vector<StageFlow>> stages;  ///< π_{k+p−1}(i, j), p = 1 … h
  double cost_m2 = 0.0;                        ///< J of (11a)
  double excess = 0.0;  ///< largest relative excess of a constraint; 0 unless softened
  int iterations = 0;   ///< of Alg. 1: linear programs solved
  int pivots = 0;
  int rows = 0;     ///< of the last program
  int columns = 0;  ///< of the last program
  /// The last program with all columns and its optimum, for comparison with other solvers; only
  /// with FtmpcOptions::keep_program.
  LinearProgram program;
  double optimum = 0.0;
};

/// The finite-time MPC (11a–h) by the sequential program of Alg. 1, as a sequence of linear
/// programs (as in the paper's third version; its τ = 10⁻³ is a tie-break).
///
/// Only constraints that bind are rows: after each program every step and obstacle is tested in
/// full and violated constraints join. Any linearisation (R) of tail_limit.hpp implies (11g), so a
/// feasible start is not needed: excess is penalised exactly, the weights of each optimum give the
/// next linearisation, and the penalised cost never rises. Stops when the flow or the cost has
/// converged.
///
/// kInfeasible names the step, the obstacle or position, and by how much α, ε or the cap would have
/// to be raised. \pre source masses positive, summing to 1; goal weights to 1.
Result<HorizonPlan> solve_ftmpc(const RiskGraph& graph, std::span<const VertexMass> sources,
                                std::span<const double> goal_weights, const FtmpcOptions& options,
                                HorizonMemory& memory);

}  // namespace swarm::planner
