// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/top_text.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

namespace swarm::monitor {

/// Totals, then the robots in the most urgent order (lost ones, then those with the smallest gap),
/// then the last events. Columns have fixed widths for a terminal.
std::string top_text(const SwarmState& state, const TopFacts& facts, UtcTime now) {
  const SwarmState::Counts counts = state.counts(now);
  const auto ms = [&](double q) {
    return 1e-3 * static_cast<double>(facts.latency.quantile_us(q));
  };
  std::string text = fmt::format(
      "{}  {}  mission {:.1f} s  plan {}\n"
      "{} of {} robots received  {} moving  {} arrived  {} lost  nearest gap {}\n"
      "{:.0f} states/s  latency p50 {:.2f} ms  p99 {:.2f} ms  {} lost  {} refused\n\n"
      "{:>6}  {:<8} {:>8} {:>8} {:>7} {:>8} {:>11} {:>7}\n",
      facts.name, to_string(state.phase()), state.mission_time_s(now), state.plan_version(),
      counts.received, state.robots().size(), counts.moving, counts.arrived, counts.lost,
      std::isfinite(counts.nearest_gap_m) ? fmt::format("{:.2f} m", counts.nearest_gap_m) : "–",
      facts.states_hz, ms(0.5), ms(0.99), state.meter().counts().lost, state.refused().total(),
      "robot", "mode", "x m", "y m", "m/s", "gap m", "neighbours", "late %");
  std::vector<std::size_t> order(state.robots().size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  // Sort key: lost robots first, robots never received last, the others by their gap.
  const auto urgency = [&](std::size_t i) {
    const SwarmState::Robot& robot = state.robots()[i];
    if (!robot.was_received) return 2e9;
    if (state.is_lost(robot, now)) return -1e9;
    return std::min(robot.nearest_gap_m, 1e9);
  };
  const std::size_t rows = std::min(facts.rows, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(rows), order.end(),
                    [&](std::size_t a, std::size_t b) { return urgency(a) < urgency(b); });
  for (std::size_t i = 0; i < rows; ++i) {
    const SwarmState::Robot& robot = state.robots()[order[i]];
    if (!robot.was_received) break;
    const Vec2 at = state.position_of(robot, now);
    text +=
        fmt::format("{:>6}  {:<8} {:>8.2f} {:>8.2f} {:>7.2f} {:>8.2f} {:>11} {:>7.2f}\n", order[i],
                    state.is_lost(robot, now) ? "lost" : to_string(robot.mode), at.x(), at.y(),
                    robot.velocity_mps.norm(), robot.nearest_gap_m, robot.neighbours,
                    robot.ticks > 0 ? 100.0 * robot.late_ticks / robot.ticks : 0.0);
  }
  const auto& events = state.events();
  text += "\n";
  for (std::size_t i = events.size() - std::min(events.size(), facts.events); i < events.size();
       ++i) {
    const auto& at_s = events[i].mission_time_s;
    text += fmt::format("{:>10}  {}  {}: {}\n", at_s ? fmt::format("{:.1f} s", *at_s) : "–",
                        events[i].source, events[i].code, events[i].text);
  }
  return text;
}

}  // namespace swarm::monitor
