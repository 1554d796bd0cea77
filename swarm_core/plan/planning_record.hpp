// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace swarm {

/// What the planning method of a run promised, for those who judge the run later. In the run
/// directory as `planning.json`.
struct PlanningRecord {
  std::string method;                          ///< its name
  std::optional<double> density_cap_per_m2{};  ///< that plans are held to [robots/m²], if any
};

/// `{"method": "swarmprm", "density_cap_per_m2": 2.05}`; null where there is no cap.
std::string to_json(const PlanningRecord& record);

/// Of such a text; nothing if it is none.
std::optional<PlanningRecord> planning_record_from_json(std::string_view text);

}  // namespace swarm
