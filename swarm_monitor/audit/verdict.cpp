// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/verdict.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "swarm_core/mission/goal_room.hpp"
#include "swarm_monitor/audit/tracking/criteria.hpp"

namespace swarm::monitor {
namespace {

using Reasons = std::vector<std::string>;

/// The first ten entries of a list and the number of the others, as in `3, 7, 12 and 40 more`: the
/// reasons of a failed audit stay readable when hundreds of robots fail.
std::string list(const std::vector<std::string>& items) {
  constexpr std::size_t kShown = 10;
  const std::vector<std::string> first(
      items.begin(), items.begin() + static_cast<std::ptrdiff_t>(std::min(items.size(), kShown)));
  std::string text = fmt::format("{}", fmt::join(first, ", "));
  if (items.size() > kShown) text += fmt::format(" and {} more", items.size() - kShown);
  return text;
}

/// Pairs of robots as text, as in `3-7, 12-9 and 40 more`.
std::string list_pairs(const std::vector<Approach>& contacts) {
  std::vector<std::string> pairs;
  for (const Approach& contact : contacts) {
    pairs.push_back(fmt::format("{}-{}", contact.robot, contact.other));
  }
  return list(pairs);
}

std::string number_of_pairs(std::uint32_t count) {
  return count == 1 ? "1 pair" : fmt::format("{} pairs", count);
}

std::string ids_of(const std::vector<RobotId>& robots) {
  std::vector<std::string> ids;
  for (const RobotId robot : robots) ids.push_back(fmt::format("{}", robot.value()));
  return list(ids);
}

void add_missing(const Audit& audit, Reasons& reasons) {
  constexpr std::size_t kMostNamed = 10;
  for (std::size_t i = 0; i < std::min(audit.missing.size(), kMostNamed); ++i) {
    reasons.push_back("missing: " + audit.missing[i]);
  }
  if (audit.missing.size() > kMostNamed) {
    reasons.push_back(fmt::format("missing: {} more", audit.missing.size() - kMostNamed));
  }
}

void add_absent(const Audit& audit, Reasons& reasons) {
  if (!audit.lost.empty()) {
    reasons.push_back(fmt::format("{} lost: robot {}", audit.lost.size(), ids_of(audit.lost)));
  }
  std::vector<RobotId> absent;
  for (const RobotAudit& robot : audit.by_robot) {
    if (!robot.lost && !robot.arrived) absent.push_back(robot.robot);
  }
  if (absent.empty()) return;
  reasons.push_back(fmt::format("{} not arrived: robot {}", absent.size(), ids_of(absent)));
}

void add_contacts(const AuditedRun& audited, Reasons& reasons) {
  const Audit& audit = audited.audit;
  if (audit.collisions_robot > 0) {
    reasons.push_back(fmt::format("{} touched: {}", number_of_pairs(audit.collisions_robot),
                                  list_pairs(audited.robots.contacts)));
  }
  if (audit.collisions_fallen > 0) {
    reasons.push_back(fmt::format("{} touched after one had died: {}",
                                  number_of_pairs(audit.collisions_fallen),
                                  list_pairs(audited.robots.fallen_contacts)));
  }
  if (audit.collisions_obstacle > 0) {
    reasons.push_back(fmt::format("{} touched obstacles",
                                  audit.collisions_obstacle == 1
                                      ? "1 robot"
                                      : fmt::format("{} robots", audit.collisions_obstacle)));
  }
}

void add_outside(const Audit& audit, Reasons& reasons) {
  if (audit.outside_bounds == 0) return;
  std::vector<RobotId> outside;
  for (const RobotAudit& robot : audit.by_robot) {
    if (robot.left_bounds) outside.push_back(robot.robot);
  }
  reasons.push_back(
      fmt::format("{} left the world's bounds: robot {}", outside.size(), ids_of(outside)));
}

/// Compares the robots in each component of the goal with its weight.
void add_uneven_goals(const AuditedRun& audited, Reasons& reasons) {
  const Mission& mission = audited.run.mission;
  const Audit& audit = audited.audit;
  // Robots that fill a drawing stop where they find room, whichever component is nearest.
  if (mission.control.shape_tolerance_m2) return;
  const auto& goals = audited.run.goal().components();
  const double tolerance = goal_tolerance(audit.robots);
  const double distance_m =
      2.0 * largest_radius_m(mission.robots) + mission.safety.neighbour_margin_m;
  for (std::size_t g = 0; g < goals.size(); ++g) {
    const double wanted = goals[g].weight * audit.robots;
    if (std::abs(audit.arrived_per_goal[g] - wanted) <= tolerance) continue;
    std::string reason = fmt::format("goal {} got {} robots, its weight is {:.1f}", g,
                                     audit.arrived_per_goal[g], wanted);
    // A goal that is full is no fault of the robots.
    const std::uint32_t room = most_in_goal(goals[g].gaussian, distance_m);
    if (audit.arrived_per_goal[g] < wanted && room < wanted) {
      reason += fmt::format("; with safety.neighbour_margin_m it has room for {} at most", room);
    }
    reasons.push_back(std::move(reason));
  }
}

}  // namespace

std::vector<std::string> reasons_for_failure(const AuditedRun& audited) {
  const Audit& audit = audited.audit;
  Reasons reasons;
  add_missing(audit, reasons);
  add_absent(audit, reasons);
  add_contacts(audited, reasons);
  add_outside(audit, reasons);
  const CriteriaSpec& criteria = audited.run.mission.criteria;
  for (std::string& reason : failed_criteria(criteria, audit.tracking, audit.path_ratio)) {
    reasons.push_back(std::move(reason));
  }
  add_uneven_goals(audited, reasons);
  return reasons;
}

}  // namespace swarm::monitor
