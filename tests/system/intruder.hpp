// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_link/adapters/fastdds/fastdds_participant.hpp"
#include "tests/system/flown_run.hpp"

namespace swarm::test {

inline std::int64_t utc_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// A foreign participant on the bus of a run on topics, which outranks the run's planner.
inline Result<std::unique_ptr<link::Participant>> intrude(const FlownRun& run) {
  const auto info = shell::read_run_info(run.dir());
  if (!info) return tl::unexpected(info.error());
  return link::make_fastdds_participant({.name = "hostile",
                                         .domain = info->domain,
                                         .index = 60,
                                         .discovery = {info->discovery_host, info->discovery_port},
                                         .ownership_strength = 1000});
}

}  // namespace swarm::test
