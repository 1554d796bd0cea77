// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/commands/plan.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "planner_service/flow/plan_density.hpp"
#include "planner_service/flow/transport_lp.hpp"
#include "planner_service/methods/builtin_methods.hpp"
#include "planner_service/passage_times.hpp"
#include "planner_service/plan_checks.hpp"
#include "planner_service/planner.hpp"
#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/metrics/shortest_paths.hpp"
#include "swarm_core/plan/plan_json.hpp"
#include "swarm_launcher/processes/builtin_catalogue.hpp"
#include "swarm_monitor/report/svg.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

// Points drawn to estimate the share of the mixture inside obstacles: a standard error of 0.05 % at
// most.
constexpr std::size_t kShareSamples = 1'000'000;
// Plan time between the instants at which the density is evaluated.
constexpr double kDensityStep_s = 0.5;

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// 0 for no values, like median().
double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

/// Mean path length [m] of the cheapest transport between the means of start and goal, with the
/// shortest obstacle-avoiding paths as costs. It serves as the reference length of the plans. NaN
/// if the transport problem has no solution.
double mean_bound_m(const Mission& mission) {
  std::vector<Vec2> from;
  std::vector<Vec2> to;
  for (const WeightedGaussian& c : mission.start.components()) from.push_back(c.gaussian.mean_m());
  for (const WeightedGaussian& c : mission.goal.components()) to.push_back(c.gaussian.mean_m());
  const auto costs = ShortestPaths(mission.world, mission.robots.radius_m).distances_m(from, to);
  const auto shipments =
      planner::solve_transport(planner::weights_of(mission.start.components()),
                               planner::weights_of(mission.goal.components()), costs);
  if (!shipments) return std::numeric_limits<double>::quiet_NaN();
  double total = 0.0;
  for (const planner::Shipment& s : *shipments) total += s.mass * costs[s.from * to.size() + s.to];
  return total;
}

/// Statistics over the plans of all seeds.
struct Sample {
  std::vector<double> nodes, edges, roadmap_ms, search_ms, transport_ms, smoothing_ms, total_ms,
      raw_ratio, ratio, cost_m, duration_s;
  std::vector<planner::PlanWarning> warnings;  // of the first plan with warnings
  std::optional<double> cap_in_force_per_m2;   // of the mission or automatic; empty: none
  bool cap_is_automatic = false;
  double cap_per_m2 = 0.0;      // the largest that shaped a plan; 0: none did
  std::uint32_t capped = 0;     // plans that it shaped
  double obstacle_share = 0.0;  // of the first plan
  double max_density_per_m2 = 0.0;
  double max_cvar_m = -std::numeric_limits<double>::infinity();
  std::uint32_t tried = 0;

  // Adds a plan. The costly evaluations are made for the first plan only.
  void add(const planner::PlanResult& result, planner::RiskPromise promise, const Mission& mission,
           double bound_m) {
    const planner::PlanStats& s = result.stats;
    nodes.push_back(static_cast<double>(s.nodes));
    edges.push_back(static_cast<double>(s.edges));
    roadmap_ms.push_back(s.roadmap_ms);
    search_ms.push_back(s.search_ms);
    transport_ms.push_back(s.transport_ms);
    smoothing_ms.push_back(s.smoothing_ms);
    total_ms.push_back(s.total_ms);
    raw_ratio.push_back(s.raw_mean_path_m / bound_m);
    ratio.push_back(s.planned_mean_path_m / bound_m);
    cost_m.push_back(s.cost_m);
    if (total_ms.size() == 1) {
      Rng rng(1);
      obstacle_share =
          planner::planned_obstacle_share(result.plan, mission.world, kShareSamples, rng);
    }
    duration_s.push_back(result.plan.duration().count());
    cap_per_m2 = std::max(cap_per_m2, s.cap_per_m2);
    capped += s.cap_per_m2 > 0.0 ? 1U : 0U;
    if (warnings.empty()) warnings = result.warnings;
    // Finding the highest density takes longer than planning, so it is done for the first plan and
    // for plans with a density cap.
    if (total_ms.size() == 1 || s.cap_per_m2 > 0.0) {
      max_density_per_m2 =
          std::max(max_density_per_m2,
                   planner::max_density(result.plan, mission.robots.count, kDensityStep_s).per_m2);
    }
    // The method decides which risk it bounds: of the whole mixture, or of each Gaussian.
    const auto largest_cvar_m = promise == planner::RiskPromise::kMixture
                                    ? planner::planned_max_mixture_cvar_m
                                    : planner::planned_max_cvar_m;
    max_cvar_m = std::max(max_cvar_m,
                          largest_cvar_m(result.plan, mission.world, mission.planner.risk_alpha));
  }

  // Keys of --json; scripts rely on their names and order.
  std::string to_json(double bound_m) const {
    const nlohmann::ordered_json json = {{"nodes", median(nodes)},
                                         {"edges", median(edges)},
                                         {"roadmap_ms", median(roadmap_ms)},
                                         {"search_ms", median(search_ms)},
                                         {"transport_ms", median(transport_ms)},
                                         {"smoothing_ms", median(smoothing_ms)},
                                         {"total_ms", median(total_ms)},
                                         {"bound_m", bound_m},
                                         {"planned_ratio_raw", mean(raw_ratio)},
                                         {"planned_ratio", mean(ratio)},
                                         {"max_cvar_m", max_cvar_m},
                                         {"obstacle_share", obstacle_share},
                                         {"max_density_per_m2", max_density_per_m2},
                                         {"capped", capped},
                                         {"cap_per_m2", cap_per_m2},
                                         {"duration_s", mean(duration_s)},
                                         {"cost_m", mean(cost_m)},
                                         {"seeds", tried},
                                         {"success", success()}};
    return json.dump(2) + "\n";
  }

  // Every plan keeps a cap of the mission. The automatic one is applied only where a plan without
  // it would be too dense for the bodies.
  std::string cap_text() const {
    if (!cap_in_force_per_m2) return "no density cap";
    const std::string cap =
        fmt::format("density cap {:.3g} robots/m2", std::max(*cap_in_force_per_m2, cap_per_m2));
    if (!cap_is_automatic) return cap + ", kept by every plan";
    if (capped == 0) return cap + " (automatic), not needed: it changed no plan";
    return fmt::format("{} (automatic), changed {} of {} plans", cap, capped, total_ms.size());
  }

  std::string to_text(double bound_m) const {
    std::string text = fmt::format(
        "{} of {} seeds planned; {:.0f} nodes, {:.0f} edges\n"
        "median time: roadmap {:.2f} + search {:.2f} + transport {:.2f} + smoothing {:.2f} = "
        "{:.2f} ms\n"
        "mean path / bound {:.3f} raw, {:.3f} smoothed (bound {:.1f} m), W2 cost {:.1f} m\n"
        "largest CVaR {:.4f} m; at most {:.2f} % of the first plan's mixture inside obstacles\n"
        "takes {:.1f} s; at most {:.3g} robots/m2; {}\n",
        total_ms.size(), tried, median(nodes), median(edges), median(roadmap_ms), median(search_ms),
        median(transport_ms), median(smoothing_ms), median(total_ms), mean(raw_ratio), mean(ratio),
        bound_m, mean(cost_m), max_cvar_m, 100.0 * obstacle_share, mean(duration_s),
        max_density_per_m2, cap_text());
    for (const planner::PlanWarning& warning : warnings) {
      text += fmt::format("warning {}: {}\n", warning.code, warning.text);
    }
    return text;
  }

  double success() const { return static_cast<double>(total_ms.size()) / tried; }
};

// Writes plan.json and plan.svg, with the roadmap under the plan. Every edge is drawn once.
Result<void> write_plan(const std::filesystem::path& out, const Mission& mission,
                        const planner::PlanResult& result) {
  std::error_code error;
  std::filesystem::create_directories(out, error);
  if (error)
    return fail(ErrorCode::kEnvironment,
                fmt::format("--out {}: {}", out.string(), error.message()));
  if (auto w = shell::write_file(out / shell::kPlanFile, to_json(result.plan)); !w) return w;

  std::vector<std::pair<Vec2, Vec2>> edges;
  for (std::uint32_t i = 0; i < result.roadmap.nodes.size(); ++i) {
    for (const auto& arc : result.roadmap.arcs_of(i)) {
      if (arc.to > i)
        edges.emplace_back(result.roadmap.nodes[i].mean_m(), result.roadmap.nodes[arc.to].mean_m());
    }
  }
  monitor::MapSvg map(mission.world);
  map.add_edges(edges);
  map.add_plan(result.plan);
  map.add_start(mission.start);
  map.add_goal(mission.goal);
  return shell::write_file(out / "plan.svg", map.finish());
}

}  // namespace

// Plans once per seed. A failed seed is counted and the others are still planned; without any plan
// the first error is returned.
Result<ExitCode> plan_mission(const PlanCommandOptions& options) {
  const auto mission = load_mission(options.mission_file, builtin_catalogue());
  if (!mission) return tl::unexpected(mission.error());
  planner::PlanningRegistry methods;
  planner::register_builtin_methods(methods);
  const double bound_m = mean_bound_m(*mission);
  Sample sample;
  std::optional<Error> failure;
  std::string times;
  for (std::uint32_t i = 0; i < options.repeat; ++i) {
    Rng rng(options.seed + i);
    auto planner = planner::Planner::make(methods, *mission, planner::PlanningUse::kOnePlan);
    if (!planner) return tl::unexpected(planner.error());
    const planner::PlanningTraits traits = planner->method().traits();
    const auto result = planner->plan({mission->world, mission->start, mission->goal},
                                      {rng, &std::chrono::steady_clock::now});
    ++sample.tried;
    if (!result) {
      if (!failure) failure = result.error();
      continue;
    }
    sample.cap_in_force_per_m2 = traits.density_cap_per_m2;
    sample.cap_is_automatic = !mission->planner.density_cap_per_m2;
    sample.add(*result, traits.risk_promise, *mission, bound_m);
    if (sample.total_ms.size() == 1 && options.times) {
      const auto passage = planner::narrowest_passage(result->plan, mission->world);
      times = planner::to_table(planner::group_times(result->plan, passage, traits.speed_mps),
                                passage, mission->robots.count);
    }
    if (sample.total_ms.size() == 1 && !options.out.empty()) {
      if (auto written = write_plan(options.out, *mission, *result); !written) {
        return tl::unexpected(written.error());
      }
    }
  }
  if (sample.total_ms.empty()) return tl::unexpected(*failure);
  std::fputs((options.json ? sample.to_json(bound_m) : sample.to_text(bound_m) + times).c_str(),
             stdout);
  if (!failure) return ExitCode::kOk;
  std::fprintf(stderr, "first failure: %s\n", failure->message.c_str());
  return ExitCode::kCriteriaNotMet;
}

}  // namespace swarm::launcher
