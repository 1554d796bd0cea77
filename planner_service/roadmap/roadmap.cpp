// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/planning/roadmap.hpp"

#include <limits>
#include <utility>

namespace swarm::planner {

// An infinite length instead of removal: node and arc numbers stay valid in a running search.
void Roadmap::close_edge(std::uint32_t a, std::uint32_t b) {
  for (const auto& [node, other] : {std::pair{a, b}, std::pair{b, a}}) {
    for (std::uint32_t i = arc_offset[node]; i < arc_offset[node + 1]; ++i) {
      if (arcs[i].to == other) arcs[i].length_m = std::numeric_limits<double>::infinity();
    }
  }
}

}  // namespace swarm::planner
