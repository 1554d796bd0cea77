// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner_service/flow/transport_lp.hpp"
#include "swarmflow/planning/roadmap.hpp"

namespace swarm::planner {

/// A shipment and its path on the roadmap, both ends included.
struct ShippedPath {
  Shipment shipment;
  std::vector<std::uint32_t> nodes;
};

/// The transport problem (13) over the cheapest paths of a roadmap.
struct PathTransport {
  std::vector<double> costs;       ///< row-major [starts × goals], +∞ where no path joins
  std::vector<ShippedPath> paths;  ///< empty where no transport is possible
};

/// Searches all paths and solves the transport problem. The first nodes of the roadmap are the
/// starts, the next the goals. \pre as of solve_transport()
PathTransport transport_on_paths(const Roadmap& roadmap, std::span<const double> supplies,
                                 std::span<const double> demands);

}  // namespace swarm::planner
