// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/flight_result.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace swarm::launcher {
namespace {

/// Why a robot was lost; empty if no fault took it.
std::string cause_of(std::uint32_t robot, const std::vector<Fault>& injected) {
  for (const Fault& fault : injected) {
    if (loses_robots(fault.kind) && fault.agent == robot) {
      return fmt::format("{} at {:.1f} s", to_string(fault.kind), to_seconds(fault.at));
    }
  }
  return "";
}

void judge_evidence(const nlohmann::json& summary, const std::vector<Fault>& injected,
                    FlightVerdict& verdict) {
  const bool was_full = std::any_of(injected.begin(), injected.end(), [](const Fault& fault) {
    return fault.kind == FaultKind::kFillDisk;
  });
  if (was_full) return;
  for (const auto& text : summary.value("missing", nlohmann::json::array())) {
    verdict.failures.push_back("missing without a full disk: " + text.get<std::string>());
  }
}

}  // namespace

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
  for (const auto& robot : summary.value("lost", nlohmann::json::array())) {
    const auto id = robot.get<std::uint32_t>();
    verdict.lost.push_back({.robot = id, .why = cause_of(id, injected)});
    if (verdict.lost.back().why.empty())
      verdict.failures.push_back(fmt::format("robot {} was lost without a fault", id));
  }
  const auto robots = summary.value("robots", 0U), arrived = summary.value("arrived", 0U);
  const auto missing = robots - arrived;
  if (missing > verdict.lost.size()) {
    verdict.failures.push_back(fmt::format("{} of {} robots neither arrived nor were lost ({})",
                                           missing - verdict.lost.size(), robots,
                                           summary.value("outcome", std::string("no outcome"))));
  }
  judge_evidence(summary, injected, verdict);
  return verdict;
}

}  // namespace swarm::launcher
