// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/papers/experiments.hpp"
#include "experiments/papers/figure.hpp"

namespace swarm::launcher {
namespace {

// Planning is nine tenths of the wall time of a flight. A quick table plans less often, at the pace
// of the steps of the horizon.
constexpr double kQuickPeriod_s = 18.0;

// Cells of the paper's tables for its three scenarios.
constexpr std::array<const char*, 3> kPublished{
    "4.28 / 170.05 / .32 / .49 | 41.35 / 269.40 / .23 / 1.96 | 66.60 / 160.11 / .078 / -0.45",
    "5.44 / 198.67 / .62 / .76 | 44.51 / 279.70 / .23 / 7.00 | 116.76 / 162.09 / .02 / -6.57",
    "6.05 / 202.26 / .58 / .34 | 58.58 / 364.16 / .23 / 6.80 | 120.78 / 159.03 / .03 / -2.96"};

// Risk levels α of the second table, with the published minutes and metres.
constexpr std::array<std::pair<double, const char*>, 3> kAlphas{
    {{0.05, "5.50 / 191.0"}, {0.15, "4.20 / 174.6"}, {0.3, "3.81 / 173.2"}}};

// Least gaps between robots and to obstacles.
struct Clearance {
  double robot_m, obstacle_m;
};
constexpr std::array<Clearance, 3> kPublishedClearance{{{.32, .49}, {.62, .76}, {.58, .34}}};

/// The paper's least distances beside ours, and which of them are worse.
void compare_clearances(Rows& rows) {
  rows.add_line(
      "\n| case | least gap robot m: paper / here | obstacle m: paper / here | here |\n"
      "|---|---|---|---|");
  for (std::size_t i = 0; i < kPublishedClearance.size(); ++i) {
    const Row& row = rows.all()[i];
    const auto& [robot_m, obstacle_m] = kPublishedClearance[i];
    const double own_robot_m = row.least([](const Flown& f) { return f.robot_gap_m; });
    const double own_obstacle_m = row.least([](const Flown& f) { return f.obstacle_gap_m; });
    const bool worse_robot = own_robot_m < robot_m;
    const bool worse_obstacle = own_obstacle_m < obstacle_m;
    rows.add_line(fmt::format("| {} | {:.2f} / {:.2f} | {:.2f} / {:.2f} | {} |", row.name, robot_m,
                              own_robot_m, obstacle_m, own_obstacle_m,
                              worse_robot && worse_obstacle ? "both worse"
                              : worse_robot                 ? "robots worse"
                              : worse_obstacle              ? "obstacles worse"
                                                            : "not worse"));
  }
}

/// Fig. 2 of the paper: the least distance to obstacles of each of the closest 30 % of the robots,
/// by α, in scenario 2; of the first seed.
void draw_distances(Rows& rows, const std::vector<std::size_t>& by_alpha) {
  constexpr double kBin_m = 0.05, kHigh_m = 2.0, kClosest = 0.3;
  std::vector<Line> lines;
  for (std::size_t a = 0; a < by_alpha.size(); ++a) {
    std::vector<double> gaps_m = rows.all()[by_alpha[a]].flown.front().obstacle_gaps_m;
    if (gaps_m.empty()) continue;
    std::sort(gaps_m.begin(), gaps_m.end());
    const auto closest = static_cast<std::size_t>(kClosest * static_cast<double>(gaps_m.size()));
    gaps_m.resize(std::max<std::size_t>(1, closest));
    lines.push_back(
        histogram_line(fmt::format("α = {}", kAlphas[a].first), gaps_m, kBin_m, kHigh_m));
  }
  rows.draw("fig2-obstacle-gaps",
            figure({.title = "Scenario 2 (stand-in map): least gap to obstacles, closest 30 %",
                    .x = "surface to surface, m; the last bin holds all beyond",
                    .y = "share of these robots"},
                   lines));
}

}  // namespace

/// Three scenarios, then scenario 2 with other risk levels α and without following the plan in
/// time.
Result<void> rover_experiment(Rows& rows) {
  const std::uint32_t robots = rows.quick() ? 60 : 500;
  const std::uint32_t seeds = rows.quick() ? 1 : 5;
  for (std::size_t i = 0; i < kPublished.size(); ++i) {
    auto mission = rows.load(fmt::format("rover_scenario{}_standin", i + 1));
    if (!mission) return tl::unexpected(mission.error());
    if (rows.quick()) mission->planner.options.set("replan_period_s", kQuickPeriod_s);
    mission->robots.count = robots;
    const std::string name = fmt::format("scenario {}", i + 1);
    if (auto added = rows.add(name, kPublished[i], *mission, seeds); !added) return added;
  }
  auto mission = rows.load("rover_scenario2_standin");
  if (!mission) return tl::unexpected(mission.error());
  if (rows.quick()) mission->planner.options.set("replan_period_s", kQuickPeriod_s);
  mission->robots.count = robots;
  // α = 0.05 is scenario 2 as it is: the same flights, which the row above holds.
  constexpr std::size_t kScenario2 = 1;
  std::vector<std::size_t> by_alpha{kScenario2};
  for (std::size_t a = 1; a < kAlphas.size(); ++a) {
    mission->planner.risk_alpha = kAlphas[a].first;
    const std::string name = fmt::format("scenario 2, α = {}", kAlphas[a].first);
    if (auto added = rows.add(name, fmt::format("{} | |", kAlphas[a].second), *mission, seeds);
        !added) {
      return added;
    }
    by_alpha.push_back(rows.all().size() - 1);
  }
  mission->planner.risk_alpha = kAlphas.front().first;
  mission->control.options.set("tracking", "free");
  if (auto added = rows.add("scenario 2, tracking: free", "| |", *mission, seeds); !added) {
    return added;
  }
  rows.may_fail();
  rows.add_line(
      "Stand-in maps: the paper prints no coordinates of its obstacles. Its minutes are of "
      "planning "
      "alone; here `plan ms` adds up all plans of a flight, one each "
      "planner.replan_period_s.");
  rows.add_published_rows("case", "ROVER min / m / gap robot / obstacle | formation | predictive");
  compare_clearances(rows);
  rows.add_line(
      "\n| α | paper min / m | mean of robots' least clearance m | / bound | mission s |\n"
      "|---|---|---|---|---|");
  for (std::size_t a = 0; a < by_alpha.size(); ++a) {
    const Row& row = rows.all()[by_alpha[a]];
    rows.add_line(fmt::format("| {}{} | {} | {:.3f} | {:.4f} | {:.1f} |", kAlphas[a].first,
                              a == 0 ? " (the flights of scenario 2 above)" : "", kAlphas[a].second,
                              row.mean([](const Flown& f) { return f.clearance_m; }),
                              row.mean([](const Flown& f) { return f.ratio(); }),
                              row.mean([](const Flown& f) { return f.mission_s; })));
  }
  draw_distances(rows, by_alpha);
  return {};
}

}  // namespace swarm::launcher
