// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

#include "swarmflow/core/cvar.hpp"
#include "swarmflow/mission/options.hpp"
#include "swarmflow/mission/section_key.hpp"

namespace swarm {

/// Key `planner`: the planning method, and the options of the built-in ones.
struct PlannerSpec {
  std::string method = "swarmprm";  ///< name of a planning method that the planner's program has
  double risk_alpha = 0.05;         ///< α of RiskLimit
  double risk_delta_m = -0.2;       ///< δ of RiskLimit [m]
  double speed_mps = 1.25;          ///< speed of the means along a route [m/s]
  /// swarmprm and rover: density cap [robots/m²]; 0: no cap. Empty, `auto` in the file: swarmprm
  /// plans at a density and a speed that the bodies can follow (body_limits.hpp), the others plan
  /// without a cap.
  std::optional<double> density_cap_per_m2;
  OptionValues options{};  ///< options that the planning methods declare
};

/// Range of `planner.risk_alpha`, also where a script or an operator changes it.
inline constexpr Range kRiskAlphaRange = between(1e-6, 1 - 1e-6);

/// Keys that every planning method reads, beside `method` and `density_cap_per_m2`.
inline constexpr auto kPlannerKeys = std::to_array<SectionKey<PlannerSpec>>({
    {"risk_alpha", &PlannerSpec::risk_alpha, kRiskAlphaRange,
     "alpha of the risk limit CVaR_alpha <= delta"},
    {"risk_delta_m", &PlannerSpec::risk_delta_m, between(-1000, 0), "delta of the risk limit"},
    {"speed_mps", &PlannerSpec::speed_mps, positive(100), "speed of the Gaussians along a route"},
});

}  // namespace swarm
