// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <span>

#include <fmt/format.h>

#include "experiments/papers/experiments.hpp"
#include "experiments/papers/figure.hpp"
#include "robot_agent/methods/diffusion/intermittent_diffusion_keys.hpp"

namespace swarm::launcher {
namespace {

/// A case of the official code. scaled() derives the other quantities that depend on the radius.
struct Case {
  const char* mission;
  double radius_m;
  std::uint32_t robots;
  double tolerance_m2;
  std::uint32_t seeds_of_descent = 20;  // gradient descent always runs to the time limit
};

constexpr std::array<Case, 4> kCases{{{"diffusion_q", 0.1, 50, 0.045},
                                      {"diffusion_q", 0.05, 150, 0.035},
                                      {"diffusion_jie", 0.1, 200, 0.18},
                                      {"diffusion_jie", 0.05, 400, 0.11}}};
constexpr std::array<Case, 2> kFineCases{
    {{"diffusion_q", 0.01, 1000, 0.01, 4}, {"diffusion_jie", 0.01, 3000, 0.04, 4}}};
constexpr double kTimeLimit_s = 60.0;

/// The mission for another radius: lengths and speeds on the scale of a robot are scaled with it,
/// the control rate inversely; the shape stays.
Mission scaled(Mission mission, const Case& c) {
  const double factor = c.radius_m / mission.robots.radius_m;
  RobotsSpec& robots = mission.robots;
  robots.count = c.robots;
  for (double* value : {&robots.radius_m, &robots.placement_gap_m, &robots.speed_max_mps,
                        &mission.control.cruise_mps, &mission.safety.neighbour_margin_m,
                        &mission.safety.obstacle_margin_m, &mission.link.communication_radius_m,
                        &mission.link.send_error_m}) {
    *value *= factor;
  }
  mission.control.rate_hz /= factor;
  OptionValues& keys = mission.control.options;
  const double gap_m = agent::intermittent_diffusion_keys().read(keys).obstacle_gap_m;
  keys.set("obstacle_gap_m", factor * gap_m);
  keys.set("diffusion_tolerance_m2", c.tolerance_m2);
  mission.launcher.time_limit_s = kTimeLimit_s;
  return mission;
}

/// Number of seeds in which E fell to the tolerance without a contact.
std::size_t formed(const Row& row, const Case& c) {
  return static_cast<std::size_t>(
      std::count_if(row.flown.begin(), row.flown.end(), [&](const Flown& f) {
        return f.contacts == 0 && !f.energy_m2.empty() &&
               *std::min_element(f.energy_m2.begin(), f.energy_m2.end()) <= c.tolerance_m2;
      }));
}

/// The error E over time, sampled every kEnergyEvery_s.
Line energy_line(const std::string& name, const Flown& flown) {
  Line line{.name = name, .points = {}};
  for (std::size_t i = 0; i < flown.energy_m2.size(); ++i) {
    line.points.emplace_back(static_cast<double>(i) * Flown::kEnergyEvery_s, flown.energy_m2[i]);
  }
  return line;
}

/// Draws E of the first seed for both methods, with the tolerance. The two newest rows are ours and
/// plain gradient descent, in this order.
void draw_energy(Rows& rows, std::size_t index, const Case& c) {
  const Flown& ours = rows.all()[rows.all().size() - 2].flown.front();
  const Flown& plain = rows.newest().flown.front();
  if (ours.energy_m2.empty() || plain.energy_m2.empty()) return;
  std::vector<Line> lines{energy_line("intermittent diffusion", ours),
                          energy_line("gradient descent", plain)};
  const double end_s = std::max(lines[0].points.back().x(), lines[1].points.back().x());
  lines.push_back({"tolerance", {{0.0, c.tolerance_m2}, {end_s, c.tolerance_m2}}});
  rows.draw(fmt::format("energy-{}", index),
            figure({.title = fmt::format("{}, {} robots of {} m", c.mission, c.robots, c.radius_m),
                    .x = "time, s",
                    .y = "E = max (F + G), m²",
                    .log_y = true},
                   lines));
}

/// Each case with intermittent diffusion and, for comparison, with a diffusion time of 0, which is
/// plain gradient descent.
Result<void> experiment(Rows& rows, std::span<const Case> cases) {
  std::string lines;
  for (std::size_t i = 0; i < (rows.quick() ? 1 : cases.size()); ++i) {
    const Case& c = cases[i];
    auto mission = rows.load(c.mission);
    if (!mission) return tl::unexpected(mission.error());
    *mission = scaled(*std::move(mission), c);
    const std::uint32_t seeds = rows.quick() ? 1 : 20;
    const std::string cells = fmt::format("{} | {} | {}", c.robots, c.radius_m, c.tolerance_m2);
    if (auto added = rows.add(c.mission, cells, *mission, seeds); !added) return added;
    const std::size_t ours = formed(rows.newest(), c);

    mission->control.options.set("diffusion_time_s", 0.0);
    const std::string plain = fmt::format("{}, gradient descent", c.mission);
    const std::uint32_t plain_seeds = std::min(seeds, c.seeds_of_descent);
    if (auto added = rows.add(plain, cells, *mission, plain_seeds); !added) return added;
    rows.may_fail();
    lines += fmt::format(
        "| {} | {} | {} of {} | {} of {} | {:.4g} |\n", c.mission, cells, ours, seeds,
        formed(rows.newest(), c), plain_seeds,
        rows.newest().mean([](auto& f) { return f.energy_m2.empty() ? 0.0 : f.energy_m2.back(); }));
    draw_energy(rows, i, c);
  }
  rows.add_published_rows("shape", "N | r m | tolerance m²");
  rows.add_line(
      "\n| shape | N | r m | tolerance m² | formed | by gradient descent | E it ends at, mean, m² "
      "|\n"
      "|---|---|---|---|---|---|---|\n" +
      lines);
  return {};
}

}  // namespace

Result<void> diffusion_experiment(Rows& rows) { return experiment(rows, kCases); }

Result<void> fine_diffusion_experiment(Rows& rows) { return experiment(rows, kFineCases); }

}  // namespace swarm::launcher
