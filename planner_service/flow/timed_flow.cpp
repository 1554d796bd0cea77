// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/timed_flow.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "planner_service/flow/plan_density.hpp"
#include "planner_service/flow/timed_network.hpp"
#include "planner_service/flow/timed_plan.hpp"
#include "swarm_core/base/assert.hpp"
#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {
namespace {

// Larger networks take minutes to solve; they are refused with an error.
constexpr std::size_t kMostArcs = 3'000'000;
// Steps beyond free flow that the first horizon has at least.
constexpr std::uint32_t kLeastExtraSteps = 8;
// Peaks are brought a little below the cap, so that a round does not end just above it.
constexpr double kBelowCap = 0.995;
// Capacities are lowered at nodes that contribute at least this share to a peak, and by no more
// than kLowestStep at once, because part of the mass of a node may move to other nodes.
constexpr double kShareThatCounts = 0.02;
constexpr double kLowestStep = 0.5;
constexpr int kNeighbouringWaves = 10;

struct Terminals {
  std::span<const double> supplies;
  std::span<const double> demands;
  std::size_t count() const { return supplies.size() + demands.size(); }
};

// Density of components that hold all of their mass [robots/m²].
double stationary_density_per_m2(std::span<const Gaussian> components,
                                 std::span<const double> masses, double robots, const Vec2& at_m) {
  double density = 0.0;
  for (std::size_t i = 0; i < masses.size(); ++i)
    density += masses[i] * components[i].density(at_m);
  return robots * density;
}

// First capacities: what a Gaussian may hold alone, reduced by the density that start or goal
// components add at its mean, and divided by the density that waves of full Gaussians one, two …
// steps before and after add to it, Σ exp(−(k d)²/2) with d the distance of waves in σ.
std::vector<double> first_capacities(const Roadmap& roadmap, const Terminals& terminals,
                                     const DensityCap& cap, double wave_spacing_m) {
  const std::span<const Gaussian> nodes(roadmap.nodes);
  std::vector<double> capacities;
  for (std::size_t v = 0; v < nodes.size(); ++v) {
    const double alone = mass_capacity(nodes[v], cap);
    if (v < terminals.count()) {
      capacities.push_back(alone);
      continue;
    }
    const Vec2& at_m = nodes[v].mean_m();
    const double stationary_per_m2 =
        std::max(stationary_density_per_m2(nodes, terminals.supplies, cap.robots, at_m),
                 stationary_density_per_m2(nodes.subspan(terminals.supplies.size()),
                                           terminals.demands, cap.robots, at_m));
    const double spacing = wave_spacing_m / std::pow(nodes[v].determinant(), 0.25);
    double waves = 1.0;
    for (int k = 1; k <= kNeighbouringWaves; ++k) {
      waves += 2.0 * std::exp(-0.5 * std::pow(k * spacing, 2));
    }
    capacities.push_back(alone * std::max(0.0, 1.0 - stationary_per_m2 / cap.max_per_m2) / waves);
  }
  return capacities;
}

// Lowers the capacity of the nodes beside each peak in proportion to its excess. Start and goal
// components are fixed. False when no capacity is left to lower.
bool lower_capacities(const std::vector<SharedPeak>& peaks, const TimedPlan& timed,
                      const DensityCap& cap, std::size_t terminals,
                      std::vector<double>& capacities) {
  std::vector<double> lowered = capacities;
  for (const SharedPeak& peak : peaks) {
    const double keep = kBelowCap * cap.max_per_m2 / peak.peak.per_m2;
    for (const DensityShare& share : peak.shares) {
      if (share.per_m2 < kShareThatCounts * peak.peak.per_m2) continue;
      for (const std::uint32_t node : {share.from, share.to}) {
        const std::uint32_t v = timed.roadmap_node[node];
        if (v < terminals) continue;
        const double used = timed.plan.nodes()[node].mass;
        lowered[v] = std::min(lowered[v], std::max(keep * used, kLowestStep * capacities[v]));
      }
    }
  }
  if (lowered == capacities) return false;
  capacities = std::move(lowered);
  return true;
}

double highest_per_m2(const std::vector<SharedPeak>& peaks) {
  double highest = 0.0;
  for (const SharedPeak& peak : peaks) highest = std::max(highest, peak.peak.per_m2);
  return highest;
}

// Σ mass · W₂ of the moves, without the cost of time that the network adds.
double cost_m(const std::vector<TimedMove>& moves, const Roadmap& roadmap) {
  double cost = 0.0;
  for (const TimedMove& move : moves) {
    cost += move.mass * wasserstein2(roadmap.nodes[move.from], roadmap.nodes[move.to]);
  }
  return cost;
}

// The horizon of the network. Doubles the time beyond free flow until the flow fits, up to
// stretch_max times the free-flow time. It never shrinks: later rounds have less capacity.
class Horizon {
 public:
  Horizon(const TimedNetwork& network, std::uint32_t free_flow, double stretch_max)
      : network_(network),
        free_flow_(free_flow),
        extra_(std::max(kLeastExtraSteps, free_flow / 4)),
        longest_(static_cast<std::uint32_t>(std::max(1.0, stretch_max) * free_flow)) {}

  std::uint32_t steps() const { return std::min(free_flow_ + extra_, longest_); }

  Result<std::vector<TimedMove>> solve(const TimedDemand& demand) {
    if (network_.arc_count(steps()) > kMostArcs) {
      return fail(ErrorCode::kInfeasible,
                  fmt::format("unrolled over {} steps of {:.1f} s the roadmap has {} arcs, more "
                              "than {}: lower planner.samples or planner.connection_radius_m",
                              steps(), network_.step_s(), network_.arc_count(steps()), kMostArcs));
    }
    for (;;) {
      if (auto moves = network_.solve(steps(), demand)) return *std::move(moves);
      const std::uint32_t tried = steps();
      extra_ *= 2;
      if (tried < longest_ && network_.arc_count(steps()) <= kMostArcs) continue;
      return fail(ErrorCode::kInfeasible,
                  fmt::format("within {:.0f} s ({:.1f} times as long as without a limit), {:.1f} % "
                              "of the swarm fit through the roadmap one after the other",
                              tried * network_.step_s(),
                              static_cast<double>(tried) / std::max(1U, free_flow_),
                              100.0 * network_.mass_that_fits(tried, demand)));
    }
  }

 private:
  const TimedNetwork& network_;
  std::uint32_t free_flow_;
  std::uint32_t extra_;
  std::uint32_t longest_;
};

// An error with the parameters that admit a denser plan or give the flow more room.
Error too_dense(const DensityCap& cap, std::string_view what) {
  return {ErrorCode::kInfeasible,
          fmt::format("{:.0f} robots at no more than {:.3f} robots/m2: {}; raise the limit on the "
                      "density, planner.sigma_max_m or planner.samples",
                      cap.robots, cap.max_per_m2, what)};
}

}  // namespace

// Each round solves the flow, samples the density of its plan, and lowers capacities beside peaks.
Result<TimedFlow> timed_flow(const Roadmap& roadmap, std::span<const double> supplies,
                             std::span<const double> demands, const DensityCap& cap,
                             const TimedFlowOptions& options, EdgeChecker& checker) {
  if (auto checked = check_components(roadmap.nodes, supplies, demands, cap); !checked) {
    return tl::unexpected(checked.error());
  }
  const Terminals terminals{supplies, demands};
  const TimedNetwork network(roadmap, supplies.size(), demands.size(),
                             {.speed = options.speed,
                              .step_s = options.step_s,
                              .detour = options.detour,
                              .delay_cost_mps = options.delay_cost_mps},
                             checker);
  const std::optional<std::uint32_t> free_flow = network.free_flow_steps();
  if (!free_flow) {
    return tl::unexpected(too_dense(cap,
                                    "no route on the roadmap leaves some start component or "
                                    "reaches some goal component, at any density"));
  }
  TimedFlow result;
  result.step_s = network.step_s();
  result.free_flow_s = *free_flow * network.step_s();
  std::vector<double> capacities =
      first_capacities(roadmap, terminals, cap, options.speed.means_mps * network.step_s());
  Horizon horizon(network, *free_flow, options.stretch_max);
  double highest = 0.0;
  for (result.rounds = 1; result.rounds <= options.rounds_max; ++result.rounds) {
    const auto moves = horizon.solve({supplies, demands, capacities});
    if (!moves) return tl::unexpected(too_dense(cap, moves.error().message));
    auto timed = timed_plan(roadmap.nodes, supplies, demands, *moves, network.step_s());
    if (!timed) {
      return tl::unexpected(too_dense(
          cap, fmt::format("{}, in steps of {:.1f} s", timed.error().message, result.step_s)));
    }
    const std::vector<SharedPeak> peaks =
        peaks_above(timed->plan, cap.robots, options.sample_s, cap.max_per_m2);
    if (peaks.empty()) {
      result.cost_m = cost_m(*moves, roadmap);
      result.max_density_per_m2 = max_density(timed->plan, cap.robots, options.sample_s).per_m2;
      result.network_arcs = network.arc_count(horizon.steps());
      result.plan = std::move(timed->plan);
      for (const std::uint32_t v : timed->roadmap_node) {
        result.is_end.push_back(v < terminals.count());
      }
      return result;
    }
    highest = highest_per_m2(peaks);
    if (!lower_capacities(peaks, *timed, cap, terminals.count(), capacities)) break;
  }
  return tl::unexpected(too_dense(
      cap, fmt::format("after {} rounds of lowering capacities the density still reaches {:.3f} "
                       "robots/m2",
                       std::min(result.rounds, options.rounds_max), highest)));
}

}  // namespace swarm::planner
