// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "robot_agent/methods/shared/shared_keys.hpp"

namespace swarm::agent {

/// The keys of a mission's control section that intermittent_diffusion reads.
struct IntermittentDiffusionKeys : ObstacleKeys {
  double strength_m2 = 0.01;
  double range_m = 0.0;
  double tolerance_m2 = 0.045;
  double gain_hz = 4.0;
  double flow_s = 2.5;
  double noise_mps05 = 3.0;
  double time_s = 10.0;

  /// R of eq. 7; the paper's robots have a range of ten radii.
  double range_or_default_m(double radius_m) const {
    return range_m > 0.0 ? range_m : 10.0 * radius_m;
  }
};

/// Names, ranges and docs of the keys.
inline const OptionTable<IntermittentDiffusionKeys>& intermittent_diffusion_keys() {
  using Keys = IntermittentDiffusionKeys;
  static const auto table =
      OptionTable<Keys>()
          .with(obstacle_keys())
          .number("diffusion_strength_m2", &Keys::strength_m2, positive(1000),
                  "G0, strength of the repulsion between robots")
          .number("diffusion_range_m", &Keys::range_m, between(0, 1000),
                  "R, range of that repulsion; 0: 10 robots.radius_m")
          .number("diffusion_tolerance_m2", &Keys::tolerance_m2, positive(1000),
                  "a robot whose F + G is within this has arrived")
          .number("diffusion_gain_hz", &Keys::gain_hz, positive(1000),
                  "speed per gradient, as far as the step bound allows")
          .number("diffusion_flow_s", &Keys::flow_s, positive(3600),
                  "longest gradient flow before diffusing (i_max steps)")
          .number("diffusion_noise_mps05", &Keys::noise_mps05, between(0, 1000),
                  "largest standard deviation of the virtual diffusion [m/sqrt(s)]")
          .number("diffusion_time_s", &Keys::time_s, between(0, 3600),
                  "longest duration of the diffusion; 0: plain gradient descent");
  return table;
}

}  // namespace swarm::agent
