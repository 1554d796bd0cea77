// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm {

/// The plan as a JSON document, for files and people:
///
///   {"nodes": [{"mean_m": [x, y], "covariance_m2": [xx, xy, yy], "time_s": t, "mass": w}, …],
///    "legs":  [{"from": 0, "to": 1, "mass": π}, …]}
///
/// For a plan that breaks its own constraints the key "excess_m" holds by how much. Numbers are
/// written so that they read back to the same bits: the digest survives the round trip.
std::string to_json(const FlowPlan& plan, double excess_m = 0.0);

/// Reads such a document; refuses wrong syntax, missing, unknown or mistyped keys (named by their
/// place, e.g. "nodes[3].mass") and everything Gaussian::make and FlowPlan::make refuse.
Result<FlowPlan> plan_from_json(std::string_view text);

/// "excess_m" of such a document, 0 where it has none or is none.
double excess_from_json(std::string_view text);

}  // namespace swarm
