// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/soak/soak_mission.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "swarm_launcher/processes/builtin_catalogue.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

// Area per robot in the middle of the swarm, as in the densest mission of the papers.
constexpr double kAreaPerRobot_m2 = 8.0;
// Of the wall between the two regions; widths in standard deviations of a region.
constexpr int kWalls = 2;
constexpr double kHalfGap = 1.5;
constexpr double kNarrow = 0.35;  // of the Gaussians that pass it
// In which there is a pause, and an obstacle comes and goes.
constexpr double kPeriod_s = 30.0;

}  // namespace

/// Two Gaussians on both sides of a wall with a wide gap, between which the whole swarm goes back
/// and forth. Twice a minute there is a pause, and an obstacle comes and goes: commands, scenes and
/// plans are sent all the time. The mission is written as YAML, so that it takes the same path as
/// every mission file.
Result<Mission> soak_mission(std::uint32_t robots, double rate_hz, double duration_s) {
  // N robots of one Gaussian are densest in its middle: N / (2π σ²).
  const double variance_m2 = std::max(4.0, robots * kAreaPerRobot_m2 / (2.0 * std::numbers::pi));
  const double sigma_m = std::sqrt(variance_m2);
  const double side_m = 14.0 * sigma_m;
  const auto dense_region_at = [&](double x_m) {
    return fmt::format("[{{mean_m: [{}, {}], covariance_m2: [[{}, 0], [0, {}]], weight: 1}}]", x_m,
                       0.5 * side_m, variance_m2, variance_m2);
  };
  const std::string ends[] = {dense_region_at(0.25 * side_m), dense_region_at(0.75 * side_m)};
  std::string yaml = fmt::format(
      "version: 1\nname: soak\nworld:\n  bounds_m: [0, 0, {0}, {0}]\n  obstacles:\n"
      "    - polygon_m: [[{7}, 0], [{8}, 0], [{8}, {9}], [{7}, {9}]]\n"
      "    - polygon_m: [[{7}, {10}], [{8}, {10}], [{8}, {0}], [{7}, {0}]]\n"
      "robots: {{count: {1}}}\nstart: {2}\ngoal: {3}\n"
      "planner: {{samples: 150, connection_radius_m: {0}, sigma_min_m: {11}, sigma_max_m: {4}}}\n"
      "control: {{rate_hz: {5}}}\nlauncher: {{time_limit_s: {6}}}\nscript:\n",
      side_m, robots, ends[0], ends[1], sigma_m, rate_hz, duration_s, 0.5 * side_m - 1.0,
      0.5 * side_m + 1.0, 0.5 * side_m - kHalfGap * sigma_m, 0.5 * side_m + kHalfGap * sigma_m,
      kNarrow * sigma_m);
  std::multimap<double, std::string> script;
  // The next goal comes before the last is reached, so that no robot stops. There is one goal more
  // than there is time for, so that the time limit ends the mission.
  const double leg_s = 0.5 * side_m / ControlSpec{}.cruise_mps;
  std::size_t goal = 0;
  for (double at_s = leg_s; at_s - leg_s <= duration_s; at_s += leg_s, goal = 1 - goal) {
    script.emplace(at_s, fmt::format("goto, goal: {}", ends[goal]));
  }
  const double period_s = std::min(kPeriod_s, duration_s / 3.0);
  int added = kWalls;  // the number of the obstacle that comes next
  for (double at_s = 0.0; at_s + period_s <= duration_s; at_s += period_s, ++added) {
    script.emplace(at_s + 0.2 * period_s, "pause");
    script.emplace(at_s + 0.25 * period_s, "resume");
    script.emplace(
        at_s + 0.5 * period_s,
        fmt::format("add_obstacle, circle_m: {{center: [{0}, {0}], radius: 1}}", 0.05 * side_m));
    script.emplace(at_s + 0.75 * period_s, fmt::format("remove_obstacle, obstacle: {}", added));
  }
  for (const auto& [at_s, action] : script) {
    fmt::format_to(std::back_inserter(yaml), "  - {{at_s: {}, action: {}}}\n", at_s, action);
  }
  return parse_mission(yaml, "the soak's own mission", {}, builtin_catalogue());
}

}  // namespace swarm::launcher
