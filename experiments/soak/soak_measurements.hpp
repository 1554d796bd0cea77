// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "experiments/soak/soak_paths.hpp"
#include "swarm_core/metrics/histogram.hpp"
#include "swarm_link/stream_meter.hpp"

namespace swarm::launcher {

/// One sample of a running swarm.
struct SoakSample {
  double time_s = 0.0;       ///< of the mission
  double cpu_share = 0.0;    ///< cores used since the last sample, all processes of the run
  double rss_mb = 0.0;       ///< of all agents together
  double rss_max_mb = 0.0;   ///< of the largest agent
  double threads = 0.0;      ///< of all agents
  double open_files = 0.0;   ///< of all agents
  double switches_hz = 0.0;  ///< context switches of all agents
  double received_hz = 0.0;  ///< states at the listener
  double p99_ms = 0.0;       ///< written → received, since the last sample
};

/// Measurements of a soak while its mission ran.
struct SoakMeasurements {
  std::vector<SoakSample> samples{};                    ///< about one a second
  std::optional<link::StreamMeter::Counts> received{};  ///< empty: the channel has no listener
  Histogram latency{};               ///< written → received by a waiting listener
  link::StreamMeter::Worst worst{};  ///< the largest latency and its robot
  Histogram use_latency{};           ///< written → used by a neighbour's controller
  PathLatencies paths{};             ///< of status, command, scene, plan and heartbeat
  std::uint64_t states_sent = 0;     ///< as the robots count
  std::uint64_t states_used = 0;
  std::uint64_t ticks = 0, late_ticks = 0;  ///< control periods, and those that began late
  std::uint64_t receive_drops = 0;          ///< by the kernel, all UDP sockets of the machine
};

}  // namespace swarm::launcher
