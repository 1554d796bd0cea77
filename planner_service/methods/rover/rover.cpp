// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/rover.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/base/assert.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "swarm_core/risk/mixture_cvar.hpp"

namespace swarm::planner {
namespace {

// Flows below this join the others that leave the same component: no robot would ride them.
constexpr double kNegligibleMass = 1e-6;

// Error of a goal weight that still counts as arrived: removing the negligible flows of dozens of
// sources may have moved this much, a tenth of one of 500 robots.
constexpr double kArrivedTolerance = 2e-4;

// Weights of the components, scaled to sum to 1: the masses of the FTMPC.
std::vector<double> normalised_weights(const Mixture& mixture) {
  std::vector<double> weights;
  double total = 0.0;
  for (const WeightedGaussian& component : mixture.components()) {
    weights.push_back(component.weight);
    total += component.weight;
  }
  for (double& weight : weights) weight /= total;
  return weights;
}

// The GMM-CVaR constraint (11g) that a mixture violates most, as an error text with the parameter
// values that would admit the mixture; empty when it keeps all constraints.
std::string broken_limit(const Mixture& mixture, const World& world, const RiskLimit& risk) {
  std::string text;
  double worst_m = risk.delta_m;
  for (const ConvexObstacle& obstacle : world.convex_obstacles()) {
    const double cvar_m = mixture_tail_risk(negated_distance(mixture, obstacle), risk.alpha).cvar_m;
    if (cvar_m <= worst_m) continue;
    worst_m = cvar_m;
    text = fmt::format(
        "CVaR {:.3f} m at obstacle {} exceeds epsilon {} m; move it, raise epsilon to {:.3f}, or "
        "raise alpha ({})",
        cvar_m, obstacle.obstacle, risk.delta_m, cvar_m + 0.01, risk.alpha);
  }
  return text;
}

// Highest density of the swarm at the means of its components [robots/m²]. Constraint (11f) tests
// the density at the same points.
double highest_density_per_m2(const Mixture& mixture, double robots) {
  double highest = 0.0;
  for (const WeightedGaussian& component : mixture.components()) {
    highest = std::max(highest, robots * mixture.density(component.gaussian.mean_m()));
  }
  return highest;
}

// Removes flows of negligible mass and scales the others, so that what leaves each vertex is
// exactly the mass that was there: the solver keeps (11b) to its tolerance alone.
std::vector<StageFlow> without_negligible(std::span<const StageFlow> flows,
                                          std::span<const VertexMass> sources) {
  std::vector<StageFlow> kept;
  for (const VertexMass& source : sources) {
    const std::size_t first = kept.size();
    StageFlow largest{source.vertex, source.vertex, 0.0};  // waits if the solver lost it
    double sum = 0.0;
    for (const StageFlow& flow : flows) {
      if (flow.from != source.vertex) continue;
      if (flow.mass > largest.mass) largest = flow;
      if (flow.mass < kNegligibleMass) continue;
      kept.push_back(flow);
      sum += flow.mass;
    }
    if (kept.size() == first) {
      kept.push_back({largest.from, largest.to, source.mass});
      continue;
    }
    for (std::size_t i = first; i < kept.size(); ++i) kept[i].mass *= source.mass / sum;
  }
  return kept;
}

// Mass at each vertex after a stage. Scaled to sum to 1, so that errors do not add up over steps.
std::vector<VertexMass> masses_after(std::span<const StageFlow> flows) {
  std::map<std::uint32_t, double> masses;
  for (const StageFlow& flow : flows) masses[flow.to] += flow.mass;
  std::vector<VertexMass> after;
  double total = 0.0;
  for (const auto& [vertex, mass] : masses) total += mass;
  for (const auto& [vertex, mass] : masses) after.push_back({vertex, mass / total});
  return after;
}

// Collects the steps of a mission into one flow.
class FlowBuilder {
 public:
  void start(const Mixture& mixture) {
    for (const WeightedGaussian& c : mixture.components()) {
      nodes_.push_back({c.gaussian, MissionTime(0.0), c.weight});
    }
  }
  // Appends a step. Its arcs begin at the nodes that the step before appended last, so that
  // step.from has to be the mixture that the step before ended with.
  void append(const RoverStep& step) {
    const std::size_t first = nodes_.size() - step.from.components().size();
    const std::size_t next = nodes_.size();
    time_s_ += step.duration_s;
    for (const WeightedGaussian& c : step.to.components()) {
      nodes_.push_back({c.gaussian, MissionTime(time_s_), c.weight});
    }
    for (const RoverStep::Arc& arc : step.arcs) {
      legs_.push_back({static_cast<std::uint32_t>(first + arc.from),
                       static_cast<std::uint32_t>(next + arc.to), arc.mass});
    }
  }
  Result<FlowPlan> finish() { return FlowPlan::make(std::move(nodes_), std::move(legs_)); }

 private:
  double time_s_ = 0.0;
  std::vector<PlanNode> nodes_;
  std::vector<PlanLeg> legs_;
};

}  // namespace

Rover::Rover(RiskGraph graph, const Mixture& goal, const RoverOptions& options)
    : graph_(std::move(graph)),
      options_(options),
      goal_(goal),
      goal_weights_(normalised_weights(goal)) {
  forget();
}

// The offline stage. The goal itself is tested against (11f) and (11g) first: no sequence of steps
// could end in a mixture that violates its constraints.
Result<Rover> Rover::make(const World& world, const Mixture& goal, const RoverOptions& options) {
  const bool valid = options.mpc.costs.horizon >= 1 && options.mpc.costs.horizon <= 10 &&
                     options.mpc.costs.lambda_stage > 0.0 &&
                     options.mpc.costs.lambda_terminal > 0.0 && options.speed_mps > 0.0 &&
                     options.mpc.max_iterations >= 1 && options.mpc.density_cap_per_m2 >= 0.0;
  if (!valid) {
    return fail(ErrorCode::kBadInput,
                fmt::format("ROVER: horizon {} must be 1 to 10, its weights {} and {}, the speed "
                            "{} m/s and the iterations {} positive, the density cap {} >= 0",
                            options.mpc.costs.horizon, options.mpc.costs.lambda_stage,
                            options.mpc.costs.lambda_terminal, options.speed_mps,
                            options.mpc.max_iterations, options.mpc.density_cap_per_m2));
  }
  auto graph = RiskGraph::make(world, goal, options.graph);
  if (!graph) return tl::unexpected(graph.error());
  if (const std::string broken = broken_limit(goal, world, options.graph.risk); !broken.empty()) {
    return fail(ErrorCode::kInfeasible, "goal: " + broken);
  }
  const double cap = options.mpc.density_cap_per_m2;
  const double density = highest_density_per_m2(goal, options.mpc.robots);
  if (cap > 0.0 && density > cap) {
    return fail(ErrorCode::kInfeasible,
                fmt::format("goal: {:.3f} robots/m2 exceed the density cap {}; widen the goal or "
                            "raise the cap",
                            density, cap));
  }
  return Rover(*std::move(graph), goal, options);
}

void Rover::forget() {
  memory_ = HorizonMemory(options_.mpc.costs.horizon, options_.graph.checks_between + 1,
                          graph_.world().convex_obstacles().size());
}

// Maps each component of the current mixture to a vertex of the graph. A component that is not a
// vertex, or whose vertex another component has taken, is added as a temporary source. An error
// names a component that no path joins to any goal component, before a linear program is built.
Result<std::vector<VertexMass>> Rover::locate(const Mixture& current) {
  graph_.drop_sources();
  std::vector<VertexMass> masses;
  const std::vector<double> weights = normalised_weights(current);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const Gaussian& g = current.components()[i].gaussian;
    std::optional<std::uint32_t> vertex = graph_.find(g);
    const auto is_it = [&](const VertexMass& m) { return m.vertex == *vertex; };
    if (!vertex || std::any_of(masses.begin(), masses.end(), is_it)) vertex = graph_.add_source(g);
    if (!vertex) {
      return fail(
          ErrorCode::kInfeasible,
          fmt::format("component {}: its mean ({:.2f}, {:.2f}) lies in an obstacle; move it", i,
                      g.mean_m().x(), g.mean_m().y()));
    }
    bool leads_on = false;
    for (std::size_t n = 0; n < graph_.goals(); ++n) {
      leads_on = leads_on || std::isfinite(graph_.to_goal_m(*vertex, n));
    }
    if (!leads_on) {
      return fail(
          ErrorCode::kInfeasible,
          fmt::format("component {} at ({:.2f}, {:.2f}): no path to any goal component; "
                      "enlarge the transport radius ({} m), or shrink the mean clearance "
                      "({} m) or the spacing ({} m)",
                      i, g.mean_m().x(), g.mean_m().y(), options_.graph.transport_radius_m,
                      options_.graph.mean_clearance_m, options_.graph.collocation.spacing_m));
    }
    masses.push_back({*vertex, weights[i]});
  }
  return masses;
}

Mixture Rover::mixture_of(std::span<const VertexMass> masses) const {
  std::vector<WeightedGaussian> components;
  for (const VertexMass& m : masses) {
    components.push_back({m.mass, graph_.vertices()[m.vertex]});
  }
  auto mixture = Mixture::make(std::move(components));
  SWARM_ASSERT(mixture.has_value());
  return *std::move(mixture);
}

// Plans h steps from the sources and takes the first. All stages are cleaned of negligible flows,
// so that the CVaR reported for each step is that of the mixture the robots would follow.
Result<RoverStep> Rover::step_from(std::span<const VertexMass> sources) {
  auto horizon = solve_ftmpc(graph_, sources, goal_weights_, options_.mpc, memory_);
  if (!horizon) return tl::unexpected(horizon.error());
  memory_.shift();
  RoverStep step;
  step.from = mixture_of(sources);
  std::vector<VertexMass> masses(sources.begin(), sources.end());
  for (std::size_t p = 0; p < horizon->stages.size(); ++p) {
    horizon->stages[p] = without_negligible(horizon->stages[p], masses);
    std::vector<VertexMass> after = masses_after(horizon->stages[p]);
    Mixture mixture = mixture_of(after);
    step.cvar_m.push_back(max_mixture_cvar_m(mixture, graph_.world(), options_.graph.risk.alpha));
    if (p == 0) {
      step.to = std::move(mixture);
      // Index of a vertex among the components of a mixture.
      const auto place = [](std::span<const VertexMass> in, std::uint32_t vertex) {
        const auto at = std::find_if(in.begin(), in.end(),
                                     [&](const VertexMass& m) { return m.vertex == vertex; });
        return static_cast<std::size_t>(at - in.begin());
      };
      for (const StageFlow& flow : horizon->stages[0]) {
        step.arcs.push_back({place(sources, flow.from), place(after, flow.to), flow.mass});
        step.duration_s = std::max(step.duration_s, wasserstein2(graph_.vertices()[flow.from],
                                                                 graph_.vertices()[flow.to]) /
                                                        options_.speed_mps);
      }
    }
    masses = std::move(after);
  }
  step.horizon = *std::move(horizon);
  return step;
}

Result<RoverStep> Rover::step(const Mixture& current) {
  auto sources = locate(current);
  if (!sources) return tl::unexpected(sources.error());
  return step_from(*sources);
}

// The swarm has arrived when its mass is at goal components alone, each with its weight.
bool Rover::arrived(std::span<const VertexMass> masses) const {
  return std::all_of(masses.begin(), masses.end(), [&](const VertexMass& m) {
    return m.vertex < graph_.goals() &&
           std::abs(m.mass - goal_weights_[m.vertex]) <= kArrivedTolerance;
  });
}

// Receding horizon over the whole mission: step after step, each from the mixture where the one
// before ended, until the goal weights are reached.
Result<RoverMission> Rover::plan(const Mixture& start, const Mixture& goal) {
  SWARM_ASSERT(goal.components().size() == goal_weights_.size());
  goal_weights_ = normalised_weights(goal);
  if (!options_.mpc.soften) {
    const std::string broken = broken_limit(start, graph_.world(), options_.graph.risk);
    if (!broken.empty()) return fail(ErrorCode::kInfeasible, "start: " + broken);
  }
  forget();
  auto located = locate(start);
  if (!located) return tl::unexpected(located.error());
  std::vector<VertexMass> masses = *std::move(located);
  RoverMission mission;
  FlowBuilder flow;
  flow.start(mixture_of(masses));
  bool is_retry = false;
  while (mission.steps.empty() || !arrived(masses)) {
    auto step = step_from(masses);
    if (!step) return tl::unexpected(step.error());
    const bool moves = step->duration_s > 0.0;
    if ((!moves && is_retry) || mission.steps.size() >= options_.max_steps) {
      return fail(ErrorCode::kInfeasible,
                  fmt::format("the swarm {} after {} steps, {:.1f} m2 of cost from the goal; raise "
                              "alpha ({}) or epsilon ({} m), or lengthen the horizon ({})",
                              moves ? "is not there" : "stands still", mission.steps.size(),
                              step->horizon.cost_m2, options_.graph.risk.alpha,
                              options_.graph.risk.delta_m, options_.mpc.costs.horizon));
    }
    if (!moves) {
      // A swarm that stops short of its goal may be held by rows that were linearised around other
      // weights. Without them the same step is solved once more; a second stop is an error.
      forget();
      is_retry = true;
      continue;
    }
    is_retry = false;
    masses = masses_after(step->horizon.stages[0]);
    flow.append(*step);
    mission.steps.push_back(*std::move(step));
  }
  auto plan = flow.finish();
  if (!plan) return tl::unexpected(plan.error());
  mission.plan = *std::move(plan);
  return mission;
}

}  // namespace swarm::planner
