// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace swarm::planner {

/// A leg of a flow before its nodes have times: it takes at least this long.
struct PacedLeg {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  double least_s = 0.0;
};

/// Earliest time of each node: the length of the longest path to it. Nothing when the legs contain
/// a cycle.
std::optional<std::vector<double>> earliest_times_s(std::size_t nodes,
                                                    std::span<const PacedLeg> legs);

/// Times that spread waiting evenly. Nodes without a leg in are left at 0 and nodes without a leg
/// out reached at their earliest time. Then, repeatedly, the path through nodes without a time that
/// has the least time for its length is paced evenly: no other path becomes tighter by that, so
/// every leg gets its least time. \pre earliest_s from earliest_times_s()
std::vector<double> paced_times_s(std::span<const double> earliest_s,
                                  std::span<const PacedLeg> legs);

}  // namespace swarm::planner
