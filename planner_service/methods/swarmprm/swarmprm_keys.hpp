// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "planner_service/methods/shared/shared_keys.hpp"

namespace swarm::planner {

/// Options of swarmprm in a mission; the text of each is shown by --describe.
struct SwarmPrmKeys : RoadmapKeys {
  std::string sampler = "fit";
  std::string density_cap = "timed";
  double sigma_min_m = 1.0;
  double sigma_max_m = 3.0;
  double rho_max = 0.6;
  double bridge_share = 0.3;
  double bridge_sigma_m = 10.0;
  std::uint32_t shortcuts = 200;
};

inline const OptionTable<SwarmPrmKeys>& swarmprm_keys() {
  using Keys = SwarmPrmKeys;
  static const auto table =
      OptionTable<Keys>()
          .choice("sampler", &Keys::sampler, {"fit", "halton", "uniform"},
                  "means by a low-discrepancy sequence and shapes squeezed to keep the risk limit "
                  "(fit) or rejected (halton); or uniform with rejection, as in the paper")
          .choice("density_cap", &Keys::density_cap, {"timed", "static"},
                  "what the density cap counts: mass through a node at each time, or (static, as "
                  "in the paper) ever")
          .with(roadmap_keys())
          .number("sigma_min_m", &Keys::sigma_min_m, between(0.01, 1000),
                  "least standard deviation per axis that the sampler draws")
          .at_most("sigma_max_m")
          .number("sigma_max_m", &Keys::sigma_max_m, between(0.01, 1000),
                  "largest standard deviation per axis that the sampler draws")
          .number("rho_max", &Keys::rho_max, between(0, 0.99), "largest |correlation|")
          .number("bridge_share", &Keys::bridge_share, between(0, 1),
                  "share of samples drawn by Boor's Gaussian sampler (1999)")
          .number("bridge_sigma_m", &Keys::bridge_sigma_m, positive(kLongest_m),
                  "standard deviation of the distance within the pairs of that sampler")
          .count("shortcuts", &Keys::shortcuts, between(0, 1'000'000),
                 "smoothing tries per route; 0: the roadmap's routes are published");
  return table;
}

}  // namespace swarm::planner
