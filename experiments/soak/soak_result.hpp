// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiments/soak/soak_measurements.hpp"
#include "swarm_core/mission/channel.hpp"

namespace swarm::launcher {

/// Limits of a soak; an empty one is not tested.
struct SoakCriteria {
  std::optional<double> max_p99_ms{};          ///< written → received
  std::optional<double> max_loss{};            ///< share, of the listener and of all receivers
  std::optional<double> max_rss_growth_pct{};  ///< of all agents together
  std::optional<double> max_late_pct{};        ///< share of control periods that began late
  std::optional<double> max_status_ms{};       ///< p99 of a status, to the launcher
  std::optional<double> max_command_ms{};      ///< p99 from a command to a robot's status
  std::optional<double> max_plan_ms{};         ///< p99 from a scene to the plan that robots follow
  std::optional<double> max_beat_ms{};         ///< longest time between two heartbeats
  std::optional<double> max_clock_error_ms{};  ///< between processes, as statuses show it
  bool is_flat = false;  ///< threads and open files must not grow by more than one in a hundred
};

/// Parameters and results of a soak.
struct SoakResult {
  std::uint32_t processes = 0, per_process = 1;
  double rate_hz = 0.0, duration_s = 0.0;
  Channel channel = Channel::kGroups;
  double discovery_s = -1.0;  ///< negative: never
  double cpu_s = 0.0;
  std::uint32_t collisions = 0;  ///< between robots, or with the map
  SoakMeasurements measured{};
  bool flown = false;  ///< to the end
};

/// A quantity at the start and the end of a soak, and its maximum.
struct Growth {
  double start = 0.0, end = 0.0, max = 0.0;
  /// Growth relative to the start [%]; 0 where nothing was measured at the start.
  double percent() const { return start > 0.0 ? 100.0 * (end - start) / start : 0.0; }
};

/// From the mean over the second tenth of the samples (the first warms up) to that over the last.
Growth growth_of(const std::vector<SoakSample>& samples, double SoakSample::*what);

/// Why a soak failed; empty if it did not. Robots that touch, and a flight cut short, fail always.
std::vector<std::string> complaints(const SoakResult& result, const SoakCriteria& criteria);

/// The result as JSON, as text for a terminal, and as a page.
std::string to_json(const SoakResult& result, const std::vector<std::string>& complaints);
std::string to_text(const SoakResult& result, const std::vector<std::string>& complaints);
/// A page of its own, with the curves over time and the distributions.
std::string to_html(const SoakResult& result, const std::vector<std::string>& complaints);

}  // namespace swarm::launcher
