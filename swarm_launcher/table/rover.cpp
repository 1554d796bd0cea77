// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <utility>

#include <fmt/format.h>

#include "swarm_launcher/table/experiments.hpp"
#include "swarm_launcher/table/figure.hpp"

namespace swarm::launcher {
namespace {

constexpr std::array<const char*, 3> kPublished{
    "4.28 / 170.05 / .32 / .49 | 41.35 / 269.40 / .23 / 1.96 | 66.60 / 160.11 / .078 / -0.45",
    "5.44 / 198.67 / .62 / .76 | 44.51 / 279.70 / .23 / 7.00 | 116.76 / 162.09 / .02 / -6.57",
    "6.05 / 202.26 / .58 / .34 | 58.58 / 364.16 / .23 / 6.80 | 120.78 / 159.03 / .03 / -2.96"};

constexpr std::array<std::pair<double, const char*>, 3> kAlphas{
    {{0.05, "5.50 / 191.0"}, {0.15, "4.20 / 174.6"}, {0.3, "3.81 / 173.2"}}};

/// Where the least distances of the robots lie, as in Fig. 2 of the paper.
void draw_distances(Rows& rows) {
  constexpr double kBin_m = 0.05, kHigh_m = 2.0;
  std::vector<Line> robots, obstacles;
  for (std::size_t i = 0; i < kPublished.size(); ++i) {
    const Row& row = rows.all()[i];
    const Flown& f = row.flown.front();
    if (f.robot_gaps_m.empty() || f.obstacle_gaps_m.empty()) continue;
    robots.push_back(histogram_line(row.name, f.robot_gaps_m, kBin_m, kHigh_m));
    obstacles.push_back(histogram_line(row.name, f.obstacle_gaps_m, kBin_m, kHigh_m));
  }
  const auto axes = [](const char* what) {
    return Axes{.title = fmt::format("Least gap of each robot to {}", what),
                .x = "surface to surface, m; the last bin holds all beyond",
                .y = "share of the robots"};
  };
  rows.draw("robot-gaps", figure(axes("another robot"), robots));
  rows.draw("obstacle-gaps", figure(axes("an obstacle"), obstacles));
}

}  // namespace

Result<void> rover_experiment(Rows& rows) {
  const std::uint32_t robots = rows.quick() ? 60 : 500;
  const std::uint32_t seeds = rows.quick() ? 1 : 5;
  for (std::size_t i = 0; i < kPublished.size(); ++i) {
    auto mission = rows.load(fmt::format("rover_scenario{}_standin", i + 1));
    if (!mission) return tl::unexpected(mission.error());
    mission->robots.count = robots;
    const std::string name = fmt::format("scenario {}", i + 1);
    if (auto added = rows.add(name, kPublished[i], *mission, seeds); !added) return added;
  }
  auto mission = rows.load("rover_scenario2_standin");
  if (!mission) return tl::unexpected(mission.error());
  mission->robots.count = robots;
  for (const auto& [alpha, published] : kAlphas) {
    mission->planner.risk_alpha = alpha;
    const std::string name = fmt::format("scenario 2, α = {}", alpha);
    if (auto added = rows.add(name, fmt::format("{} | |", published), *mission, seeds); !added) {
      return added;
    }
  }
  rows.say_rows("case", "ROVER min / m / gap robot / obstacle | formation | predictive");
  rows.say(
      "\n| α | mean of robots' least clearance m | robot-time nearer than 0.2 m, promised ≤ α | / "
      "bound |\n|---|---|---|---|");
  for (std::size_t i = 0; i < kAlphas.size(); ++i) {
    const Row& row = rows.all()[kPublished.size() + i];
    rows.say(fmt::format("| {} | {:.3f} | {:.5f} | {:.4f} |", kAlphas[i].first,
                         row.mean([](const Flown& f) { return f.clearance_m; }),
                         row.mean([](const Flown& f) { return f.risk_share; }),
                         row.mean([](const Flown& f) { return f.ratio(); })));
  }
  draw_distances(rows);
  return {};
}

}  // namespace swarm::launcher
