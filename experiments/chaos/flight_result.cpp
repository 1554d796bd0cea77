// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/flight_result.hpp"

#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace swarm::launcher {

FlightVerdict judge_flight(const nlohmann::json& summary, const std::vector<Fault>& injected) {
  FlightVerdict verdict;
  if (!summary.is_object() || !summary.contains("collisions_robot") ||
      !summary["collisions_robot"].is_number()) {
    verdict.failures.push_back("the flight has no audited summary");
    return verdict;
  }
  for (const char* kind : {"collisions_robot", "collisions_obstacle", "collisions_fallen"}) {
    verdict.contacts += summary.value(kind, 0U);
  }
  if (verdict.contacts > 0)
    verdict.failures.push_back(fmt::format("{} contacts", verdict.contacts));
  std::set<std::uint32_t> killed;
  for (const Fault& fault : injected) {
    if (fault.kind == FaultKind::kKillAgent) killed.insert(fault.agent);
  }
  for (const auto& robot : summary.value("lost", nlohmann::json::array())) {
    const auto id = robot.get<std::uint32_t>();
    verdict.lost.push_back(id);
    if (!killed.contains(id))
      verdict.failures.push_back(fmt::format("robot {} was lost without a fault", id));
  }
  const auto robots = summary.value("robots", 0U), arrived = summary.value("arrived", 0U);
  const auto missing = robots - arrived;
  if (missing > verdict.lost.size()) {
    verdict.failures.push_back(fmt::format("{} of {} robots neither arrived nor were lost ({})",
                                           missing - verdict.lost.size(), robots,
                                           summary.value("outcome", std::string("no outcome"))));
  }
  return verdict;
}

}  // namespace swarm::launcher
