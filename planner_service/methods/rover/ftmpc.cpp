// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/ftmpc.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "planner_service/methods/rover/horizon_program.hpp"
#include "planner_service/methods/rover/tail_limit.hpp"
#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

// Rows stay this far, relatively, from their limit: removing negligible masses changes a row by
// less.
constexpr double kRowMargin = 1e-4;

// A constraint at more than this share of its limit becomes a row before it is violated.
constexpr double kWatchShare = 0.9;

// A row stays as it is when its z would move by less. It touches the limit there, so the optimum
// would change by the square of this.
constexpr double kSameTail_m = 1e-4;

// A row below this share of its limit does not bind.
constexpr double kBindingShare = 0.99;

// A row below this share is not handed to the next step.
constexpr double kForgetShare = 0.5;

// Excess that counts as such, above the solver's tolerance.
constexpr double kNoExcess = 1e-6;

// Densities beyond this Mahalanobis distance squared are below 1e-10 of the peak.
constexpr double kDensityReach2 = 46.0;

// A row leaves out components whose mean is this many σ before its tail: the share of each in the
// risk is below 1e-6, and of all together below the margin.
constexpr double kNegligibleSigmas = 5.0;

// The relative decrease of J below which the sequence has converged.
constexpr double kConverged = 1e-6;

// The constraint that a row linearises: one obstacle, or one density point, at one time.
struct Constraint {
  std::size_t step = 1;
  std::size_t part = 0;   // of the step: 0 at its end, else between; kDensity is none of both
  std::size_t place = 0;  // convex obstacle, or vertex at whose mean the density counts
};
constexpr std::size_t kDensity = static_cast<std::size_t>(-1);

// How far a constraint is used up by the current weights.
struct Use {
  Constraint constraint;
  double share = 0.0;  // of the limit; above 1 violates it
};

// The weights of a step: ω at its end, π of the stage that leads there.
struct StepWeights {
  std::vector<double> vertex, arc;
  std::span<const double> of(std::size_t part) const { return part == 0 ? vertex : arc; }
};

// The constraints (11f) and (11g) and the rows that stand for those that bind.
class Constraints {
 public:
  Constraints(const RiskGraph& graph, const HorizonNetwork& network, const FtmpcOptions& options)
      : graph_(graph), network_(network), options_(options), risk_(graph.options().risk) {
    const std::size_t obstacles = graph.world().convex_obstacles().size();
    risk_row_.assign(options.costs.horizon * parts() * obstacles, -1);
    density_row_.assign(options.costs.horizon * graph.vertices().size(), -1);
  }

  const std::vector<WeightRow>& rows() const { return rows_; }

  // Adds the rows of the MPC step before, so that the first program starts near its optimum.
  void recall(HorizonMemory& memory) {
    for (std::size_t step = 1; step <= options_.costs.horizon; ++step) {
      for (std::size_t part = 0; part < parts(); ++part) {
        for (std::size_t o = 0; o < obstacles(); ++o) {
          const double from_m = memory.from_m(step, part, o);
          if (std::isfinite(from_m)) set_risk_row({step, part, o}, from_m);
        }
      }
    }
  }

  // Renews the rows there are for these weights and adds those that are needed. False when all stay
  // as they are, and so would the optimum.
  bool renew(std::size_t step, const StepWeights& weights, HorizonMemory& memory) {
    bool changed = false;
    for (std::size_t part = 0; part < parts(); ++part) {
      for (std::size_t o = 0; o < obstacles(); ++o) {
        const Constraint constraint{step, part, o};
        const TailAtLimit tail = risk_tail(constraint, weights);
        if (tail.probability == 0.0) continue;
        const bool is_new = risk_row(constraint) < 0;
        if (is_new && tail.probability < kWatchShare * risk_.alpha) continue;
        double& from_m = memory.from_m(step, part, o);
        if (!is_new && stays(tail, from_m)) continue;
        from_m = tail.from_m;
        set_risk_row(constraint, from_m);
        changed = true;
      }
    }
    if (options_.density_cap_per_m2 <= 0.0) return changed;
    for (std::uint32_t place = 0; place < graph_.vertices().size(); ++place) {
      const Constraint constraint{step, kDensity, place};
      if (density_row(constraint) >= 0 || density_use(place, weights) < kWatchShare) continue;
      add_density_row(constraint);
      changed = true;
    }
    return changed;
  }

  // The constraint most used at these weights. Forgets where those were linearised that are far
  // from binding.
  Use most_used(std::size_t step, const StepWeights& weights, HorizonMemory& memory) const {
    Use most;
    for (std::size_t part = 0; part < parts(); ++part) {
      for (std::size_t o = 0; o < obstacles(); ++o) {
        const Constraint constraint{step, part, o};
        const double share = risk_tail(constraint, weights).probability / risk_.alpha;
        if (share < kForgetShare) {
          memory.from_m(step, part, o) = std::numeric_limits<double>::quiet_NaN();
        }
        if (share > most.share) most = {constraint, share};
      }
    }
    if (options_.density_cap_per_m2 <= 0.0) return most;
    for (std::uint32_t place = 0; place < graph_.vertices().size(); ++place) {
      const double share = density_use(place, weights);
      if (share > most.share) most = {{step, kDensity, place}, share};
    }
    return most;
  }

  // A use above the limit, as a sentence for a person.
  std::string describe(const Use& use, const StepWeights& weights) const;

 private:
  std::size_t parts() const { return graph_.options().checks_between + 1; }
  std::size_t obstacles() const { return graph_.world().convex_obstacles().size(); }
  // Index into rows_ of the row that stands for a constraint, −1 when there is none.
  int& risk_row(const Constraint& c) {
    return risk_row_[((c.step - 1) * parts() + c.part) * obstacles() + c.place];
  }
  int& density_row(const Constraint& c) {
    return density_row_[(c.step - 1) * graph_.vertices().size() + c.place];
  }

  // The row at an index of the above, a new one if there is none yet.
  WeightRow& row_at(int& index, const Constraint& constraint) {
    if (index < 0) {
      index = static_cast<int>(rows_.size());
      const bool by_arc = constraint.part != kDensity && constraint.part > 0;
      rows_.push_back({constraint.step, by_arc, {}});
    }
    WeightRow& row = rows_[static_cast<std::size_t>(index)];
    row.entries.clear();
    return row;
  }

  // Writes the row (R) of tail_limit.hpp for the linearisation point z, divided by its right side α
  // (1 − margin), so that the limit of every row is 1. Vertices that the swarm cannot reach in this
  // step carry no mass and are left out.
  void set_risk_row(const Constraint& constraint, double from_m) {
    WeightRow& row = row_at(risk_row(constraint), constraint);
    for (const RiskGraph::Near& near : graph_.near(constraint.part, constraint.place)) {
      if (constraint.part == 0 && !network_.in_layer(constraint.step, near.index)) continue;
      if (near.line.mean_m + kNegligibleSigmas * near.line.sigma_m < from_m) continue;
      const double share = risk_share(near.line, from_m, risk_.delta_m);
      row.entries.push_back({near.index, share / (risk_.alpha * (1.0 - kRowMargin))});
    }
  }

  // Writes the row of (11f) for one density point. It is linear in the weights as it stands, so
  // that it is never renewed.
  void add_density_row(const Constraint& constraint) {
    WeightRow& row = row_at(density_row(constraint), constraint);
    for (std::uint32_t v = 0; v < graph_.vertices().size(); ++v) {
      if (!network_.in_layer(constraint.step, v)) continue;
      const double share = density_share(v, static_cast<std::uint32_t>(constraint.place));
      if (share > 0.0) row.entries.push_back({v, share / (1.0 - kRowMargin)});
    }
  }

  // Whether renewing a row would not change the optimum: its z hardly moves, or it does not bind.
  // \pre risk_tail() was called for the same constraint last: line_ holds its components
  bool stays(const TailAtLimit& tail, double from_m) const {
    if (std::abs(tail.from_m - from_m) <= kSameTail_m) return true;
    double used = 0.0;
    for (const LineComponent& c : line_) used += c.weight * risk_share(c, from_m, risk_.delta_m);
    return used < kBindingShare * risk_.alpha;
  }

  // The tail of the current mixture at one obstacle, from the components near it that carry mass.
  TailAtLimit risk_tail(const Constraint& constraint, const StepWeights& weights) const {
    const std::span<const double> weight = weights.of(constraint.part);
    line_.clear();
    for (const RiskGraph::Near& near : graph_.near(constraint.part, constraint.place)) {
      if (weight[near.index] <= 0.0) continue;
      line_.push_back({weight[near.index], near.line.mean_m, near.line.sigma_m});
    }
    return tail_at_limit(line_, risk_.delta_m);
  }

  // Density that a whole swarm in one vertex would have at the mean of another, as a share of the
  // cap.
  double density_share(std::uint32_t vertex, std::uint32_t place) const {
    const Gaussian& g = graph_.vertices()[vertex];
    const Vec2& at_m = graph_.vertices()[place].mean_m();
    if (g.mahalanobis_squared(at_m) > kDensityReach2) return 0.0;
    return options_.robots * g.density(at_m) / options_.density_cap_per_m2;
  }

  // Share of the density cap that the current weights use at one density point.
  double density_use(std::uint32_t place, const StepWeights& weights) const {
    double share = 0.0;
    for (std::uint32_t v = 0; v < weights.vertex.size(); ++v) {
      if (weights.vertex[v] > 0.0) share += weights.vertex[v] * density_share(v, place);
    }
    return share;
  }

  const RiskGraph& graph_;
  const HorizonNetwork& network_;
  const FtmpcOptions& options_;
  const RiskLimit& risk_;
  std::vector<int> risk_row_, density_row_;  // index into rows_, −1 for none
  std::vector<WeightRow> rows_;
  mutable std::vector<LineComponent> line_;  // scratch
};

std::string Constraints::describe(const Use& use, const StepWeights& weights) const {
  const Constraint& c = use.constraint;
  if (c.part == kDensity) {
    const Vec2& at_m = graph_.vertices()[c.place].mean_m();
    const double density = use.share * options_.density_cap_per_m2;
    return fmt::format(
        "{:.3f} robots/m2 at ({:.1f}, {:.1f}) in step {} are the least found, the density cap is "
        "{}; raise it to {:.3f}",
        density, at_m.x(), at_m.y(), c.step, options_.density_cap_per_m2, density * 1.01);
  }
  // Without the rest of the mass the CVaR would be too high: the rest enters as one component 1 km
  // from the obstacle.
  std::vector<LineComponent> line;
  double far = 1.0;
  for (const RiskGraph::Near& near : graph_.near(c.part, c.place)) {
    const double weight = weights.of(c.part)[near.index];
    if (weight <= 0.0) continue;
    line.push_back({weight, near.line.mean_m, near.line.sigma_m});
    far -= weight;
  }
  if (far > 0.0) line.push_back({far, -1e3, 1.0});
  const double cvar_m = mixture_tail_risk(line, risk_.alpha).cvar_m;
  return fmt::format(
      "CVaR {:.3f} m at obstacle {} in step {} is the least found, epsilon is {} m; raise epsilon "
      "to {:.3f} m, or alpha from {} to {:.3f}",
      cvar_m, graph_.world().convex_obstacles()[c.place].obstacle, c.step, risk_.delta_m,
      cvar_m + 0.01, risk_.alpha, 1.01 * risk_.alpha * use.share);
}

// The columns of the plan made a step ago, completed by waiting.
std::vector<std::size_t> likely_columns(const HorizonNetwork& network, HorizonMemory& memory) {
  std::vector<std::size_t> likely;
  const std::size_t last = network.horizon() - 1;
  for (std::size_t c = 0; c < network.columns().size(); ++c) {
    const HorizonNetwork::Column& column = network.columns()[c];
    if (column.stage > last) break;
    const auto& arcs = memory.arcs()[column.stage];
    bool is_likely =
        std::find(arcs.begin(), arcs.end(), std::pair(column.from, column.to)) != arcs.end();
    if (column.stage == last && last > 0 && column.from == column.to) {
      const auto& before = memory.arcs()[last - 1];
      is_likely = is_likely || std::any_of(before.begin(), before.end(), [&](const auto& arc) {
                    return arc.second == column.from;
                  });
    }
    if (is_likely) likely.push_back(c);
  }
  return likely;
}

// Euclidean norm ‖F^v − F^{v−1}‖ of Alg. 1.
double distance(std::span<const double> a, std::span<const double> b) {
  double squared = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) squared += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(squared);
}

/// Reads the flow of the solution back into the plan and remembers its arcs. Costs were scaled by
/// the collocation spacing (horizon_network.hpp).
void read_flow(const HorizonNetwork& network, std::span<const double> x, double unit_m,
               HorizonPlan& plan, HorizonMemory& memory) {
  const std::size_t horizon = memory.arcs().size();
  plan.stages.resize(horizon);
  for (auto& arcs : memory.arcs()) arcs.clear();
  for (std::size_t c = 0; c < network.columns().size(); ++c) {
    const HorizonNetwork::Column& column = network.columns()[c];
    plan.cost_m2 += column.cost * x[c] * unit_m * unit_m;
    if (column.stage < horizon && x[c] > 0.0) {
      plan.stages[column.stage].push_back({column.from, column.to, x[c]});
      memory.arcs()[column.stage].emplace_back(column.from, column.to);
    }
  }
}

}  // namespace

HorizonMemory::HorizonMemory(std::size_t horizon, std::size_t parts, std::size_t obstacles)
    : parts_(parts),
      obstacles_(obstacles),
      from_m_(horizon * parts * obstacles, std::numeric_limits<double>::quiet_NaN()),
      arcs_(horizon) {}

// The last step keeps its linearisation, since no later one exists; its arcs are cleared.
void HorizonMemory::shift() {
  std::copy(from_m_.begin() + static_cast<std::ptrdiff_t>(parts_ * obstacles_), from_m_.end(),
            from_m_.begin());
  std::rotate(arcs_.begin(), arcs_.begin() + 1, arcs_.end());
  arcs_.back().clear();
}

// Alg. 1: solve a linear program, linearise the violated constraints at its optimum, repeat. Rows
// are added or renewed only; the program starts each time from the basis of the one before.
Result<HorizonPlan> solve_ftmpc(const RiskGraph& graph, std::span<const VertexMass> sources,
                                std::span<const double> goal_weights, const FtmpcOptions& options,
                                HorizonMemory& memory) {
  const HorizonNetwork network(graph, sources, goal_weights, options.costs);
  HorizonProgram program(network, likely_columns(network, memory));
  Constraints constraints(graph, network, options);
  constraints.recall(memory);
  const auto weights_at = [&](std::size_t step, std::span<const double> x) {
    return StepWeights{network.vertex_weights(step, x), network.arc_weights(step, x)};
  };
  HorizonPlan plan;
  LpSolution solution;
  std::vector<double> last_x;
  double last_cost = std::numeric_limits<double>::infinity();
  std::size_t rows = 0;
  while (plan.iterations < options.max_iterations) {
    // New rows may raise the cost, so that costs are compared only between programs with the same
    // rows.
    const bool same_rows = plan.iterations > 0 && constraints.rows().size() == rows;
    rows = constraints.rows().size();
    solution = program.solve(constraints.rows());
    ++plan.iterations;
    plan.pivots += solution.pivots;
    if (solution.status != LpStatus::kOptimal) break;
    const bool converged = same_rows && (distance(solution.x, last_x) <= options.eta ||
                                         last_cost - solution.objective <=
                                             kConverged * (1.0 + std::abs(solution.objective)));
    if (converged) break;
    last_x = solution.x;
    last_cost = solution.objective;
    bool changed = false;
    for (std::size_t step = 1; step <= options.costs.horizon; ++step) {
      changed |= constraints.renew(step, weights_at(step, solution.x), memory);
    }
    if (!changed) break;
  }
  if (solution.status != LpStatus::kOptimal) {
    return fail(
        ErrorCode::kInfeasible,
        "no paths that join the swarm with the goal's weights; enlarge the transport radius "
        "or shrink the mean clearance");
  }
  // The rows are linearisations: the optimum is tested against the constraints themselves.
  Use most;
  for (std::size_t step = 1; step <= options.costs.horizon; ++step) {
    const StepWeights weights = weights_at(step, solution.x);
    const Use use = constraints.most_used(step, weights, memory);
    if (use.share > 1.0 + kNoExcess && !options.soften) {
      return fail(ErrorCode::kInfeasible, constraints.describe(use, weights));
    }
    if (use.share > most.share) most = use;
  }
  plan.excess = most.share > 1.0 + kNoExcess ? most.share - 1.0 : 0.0;
  plan.rows = static_cast<int>(network.right_side().size() + rows);
  plan.columns = static_cast<int>(network.columns().size());
  plan.optimum = solution.objective;
  if (options.keep_program) plan.program = program.whole(constraints.rows());
  read_flow(network, solution.x, graph.options().collocation.spacing_m, plan, memory);
  return plan;
}

}  // namespace swarm::planner
