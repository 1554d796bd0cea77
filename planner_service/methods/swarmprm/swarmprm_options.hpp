// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "planner_service/flow/density_cap.hpp"
#include "planner_service/roadmap/sampler.hpp"
#include "swarmflow/core/cvar.hpp"
#include "swarmflow/mission/body_limits.hpp"
#include "swarmflow/planning/planning_registry.hpp"

namespace swarm::planner {

/// Numbers of SwarmPRM; lengths in metres.
struct SwarmPrmOptions {
  std::size_t samples = 500;          ///< n of Alg. 1
  double connection_radius_m = 20.0;  ///< r of Alg. 1, in W₂
  RiskLimit risk{};
  SamplerOptions sampler{};
  std::uint32_t shortcuts =
      200;                  ///< smoothing tries per route; 0 leaves the roadmap's routes alone
  double speed_mps = 1.25;  ///< of the means along a route
  DensityCap density{};     ///< requested; 0 = none
  SwarmLimits limits{};     ///< what the bodies can follow; zeros: not known, nothing is limited
  bool cap_is_automatic = false;  ///< no cap unless the plan is denser than `limits`
  bool density_is_timed = true;   ///< counts mass at each time; else all that ever passes
  bool keeps_roadmap = true;      ///< for the next plan, which repairs it; costs more at first
};

/// The options of a mission. Where its density cap is `auto` the speed is that of the limits at
/// most.
SwarmPrmOptions swarmprm_options(const MethodContext& context);

}  // namespace swarm::planner
