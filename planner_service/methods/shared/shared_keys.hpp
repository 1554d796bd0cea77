// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "swarmflow/mission/option_table.hpp"

/// Keys of the mission's planner section that more than one built-in method reads.
namespace swarm::planner {

inline constexpr double kLongest_m = 1e6;  ///< no robot drives farther than this

/// Of methods with a roadmap.
struct RoadmapKeys {
  std::uint32_t samples = 500;
  double connection_radius_m = 20.0;
};

inline OptionTable<RoadmapKeys> roadmap_keys() {
  return OptionTable<RoadmapKeys>()
      .count("samples", &RoadmapKeys::samples, between(1, 100'000),
             "n: number of nodes of the roadmap")
      .number("connection_radius_m", &RoadmapKeys::connection_radius_m, positive(kLongest_m),
              "r: nodes nearer to each other are connected; swarmprm: in W2");
}

/// Of methods with a collocation set.
struct CollocationKeys {
  double collocation_spacing_m = 10.0;
  double collocation_sigma_m = 7.0710678118654755;
  double transport_radius_m = 22.5;
};

inline OptionTable<CollocationKeys> collocation_keys() {
  using Keys = CollocationKeys;
  return OptionTable<Keys>()
      .number("collocation_spacing_m", &Keys::collocation_spacing_m, positive(kLongest_m),
              "spacing of the grid of the collocation set C")
      .number("collocation_sigma_m", &Keys::collocation_sigma_m, between(0.01, 1000),
              "standard deviation of its Gaussians per axis")
      .number("transport_radius_m", &Keys::transport_radius_m, positive(kLongest_m),
              "W2 distance within which mass may move in one step (ROVER, Assumption 2)");
}

}  // namespace swarm::planner
