// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <chrono>

#include <fmt/format.h>

#include "experiments/papers/experiments.hpp"
#include "experiments/papers/figure.hpp"

namespace swarm::launcher {
namespace {

constexpr std::array kLosses{0.0, 0.1, 0.2, 0.3, 0.4};
constexpr std::array kDelays_ms{0, 50, 150, 300};
// Robots of the sweep.
constexpr std::uint32_t kRobots = 100;

/// Jitter is a third of the delay.
LinkFaults faults_of(double loss, int delay_ms) {
  return {.loss = loss,
          .delay = std::chrono::milliseconds(delay_ms),
          .jitter = std::chrono::milliseconds(delay_ms / 3)};
}

/// Loss and delay as two cells of the table.
std::string cells_of(const LinkFaults& faults) {
  return fmt::format("{:.0f} % | {:.0f} ± {:.0f} ms", 100.0 * faults.loss,
                     1e3 * to_seconds(faults.delay), 1e3 * to_seconds(faults.jitter));
}

/// Flies all combinations of loss and delay, and draws a line over the loss for every delay. These
/// runs may fail: they show at which loss the mission breaks down.
Result<void> sweep(Rows& rows, const Mission& mission) {
  std::vector<Line> path, time, arrived;
  for (const int delay_ms : kDelays_ms) {
    if (rows.quick() && delay_ms != 150) continue;
    const std::string name = fmt::format("{} ms", delay_ms);
    for (auto* lines : {&path, &time, &arrived}) lines->push_back({name, {}, true});
    for (const double loss : kLosses) {
      if (rows.quick() && loss != 0.2) continue;
      SimulationOptions options;
      options.faults = faults_of(loss, delay_ms);
      if (auto added = rows.add(fmt::format("{} robots", mission.robots.count),
                                cells_of(options.faults), mission, rows.quick() ? 1 : 5, options);
          !added) {
        return added;
      }
      rows.may_fail();
      const Row& row = rows.newest();
      const double percent = 100.0 * loss;
      path.back().points.emplace_back(percent, row.mean([](auto& f) { return f.ratio(); }));
      time.back().points.emplace_back(percent, row.mean([](auto& f) { return f.mission_s; }));
      arrived.back().points.emplace_back(
          percent, row.mean([](auto& f) { return 100.0 * f.arrived / f.robots; }));
    }
  }
  const auto axes = [&](const char* title, const char* y) {
    return Axes{.title = fmt::format("{}, {} robots, a line per delay", title, kRobots),
                .x = "loss, %",
                .y = y};
  };
  rows.draw("path", figure(axes("Path", "mean path / geodesic bound"), path));
  rows.draw("time", figure(axes("Mission time", "s"), time));
  rows.draw("arrived", figure(axes("Arrival", "%"), arrived));
  return {};
}

}  // namespace

/// The sweep, then two swarm sizes with a perfect and a bad network, which must not fail, and last
/// all faults together with clocks out of step and noisy positions.
Result<void> network_experiment(Rows& rows) {
  auto mission = rows.load("swarmprm_standin");
  if (!mission) return tl::unexpected(mission.error());
  mission->robots.count = kRobots;
  if (auto swept = sweep(rows, *mission); !swept) return swept;

  SimulationOptions bad;
  bad.faults = {.loss = 0.2,
                .delay = std::chrono::milliseconds(150),
                .jitter = std::chrono::milliseconds(50)};
  const std::uint32_t seeds = rows.quick() ? 1 : 20;
  for (const std::uint32_t robots : {100U, 500U}) {
    if (rows.quick() && robots > 100U) break;
    mission->robots.count = robots;
    for (const bool is_bad : {false, true}) {
      const SimulationOptions& options = is_bad ? bad : SimulationOptions{};
      if (auto added = rows.add(fmt::format("{} robots", robots), cells_of(options.faults),
                                *mission, seeds, options);
          !added) {
        return added;
      }
    }
  }
  // All faults at once.
  SimulationOptions worst = bad;
  worst.faults.delay = std::chrono::milliseconds(300);
  worst.clocks_in_step = false;
  mission->robots.count = kRobots;
  mission->robots.position_noise_m = 0.05;
  if (auto added = rows.add(fmt::format("{} robots, clocks apart, 5 cm noise", kRobots),
                            cells_of(worst.faults), *mission, seeds, worst);
      !added) {
    return added;
  }
  rows.add_published_rows("swarm", "loss | delay");
  return {};
}

}  // namespace swarm::launcher
