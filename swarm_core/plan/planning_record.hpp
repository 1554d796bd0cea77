// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace swarm {

/// What the planning method of a run guarantees, for the audit. In the run directory as
/// `planning.json`.
struct PlanningRecord {
  std::string method;                          ///< its name
  std::optional<double> density_cap_per_m2{};  ///< that plans are held to [robots/m²], if any
};

/// `{"method": "swarmprm", "density_cap_per_m2": 2.05}`; null where there is no cap.
std::string to_json(const PlanningRecord& record);

/// Reads what to_json() wrote; nothing if the text is not such a record.
std::optional<PlanningRecord> planning_record_from_json(std::string_view text);

}  // namespace swarm
