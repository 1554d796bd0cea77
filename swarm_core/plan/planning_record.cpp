// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/plan/planning_record.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

namespace swarm {

std::string to_json(const PlanningRecord& record) {
  nlohmann::ordered_json json = {{"method", record.method}, {"density_cap_per_m2", nullptr}};
  if (record.density_cap_per_m2) json["density_cap_per_m2"] = *record.density_cap_per_m2;
  return json.dump(2) + "\n";
}

// A cap that is absent, null or not positive counts as no cap.
std::optional<PlanningRecord> planning_record_from_json(std::string_view text) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  const auto method = json.find("method");
  if (method == json.end() || !method->is_string()) return std::nullopt;
  PlanningRecord record{.method = method->get<std::string>()};
  const auto cap = json.find("density_cap_per_m2");
  if (cap != json.end() && cap->is_number() && std::isfinite(cap->get<double>()) &&
      cap->get<double>() > 0.0) {
    record.density_cap_per_m2 = cap->get<double>();
  }
  return record;
}

}  // namespace swarm
