// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission/mission_rules.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/mission/goal_room.hpp"

namespace swarm {
namespace {

/// One side of an inequality: the path of a key and its value.
struct Side {
  std::string key;
  double value = 0.0;
};

/// Collects rules of the form "culprit ≤ limit".
class Rules {
 public:
  void at_most(const Side& culprit, const Side& limit) {
    if (culprit.value <= limit.value) return;
    add({culprit.key, limit.key}, fmt::format("{} is {}; must be <= {} ({})", culprit.key,
                                              culprit.value, limit.key, limit.value));
  }
  void below(const Side& culprit, const Side& limit) {
    if (culprit.value < limit.value) return;
    add({culprit.key, limit.key}, fmt::format("{} is {}; must be < {} ({})", culprit.key,
                                              culprit.value, limit.key, limit.value));
  }
  void add(std::vector<std::string> keys, std::string message) {
    broken.push_back({std::move(keys), std::move(message)});
  }
  std::vector<BrokenRule> broken;
};

/// A body that some robots have, with its path in the mission file.
struct BodyInUse {
  std::string path;
  const BodySpec* spec;
};

std::vector<BodyInUse> bodies_in_use(const RobotsSpec& robots) {
  std::vector<BodyInUse> bodies;
  std::uint64_t grouped = 0;
  for (std::size_t i = 0; i < robots.groups.size(); ++i) {
    bodies.push_back({fmt::format("robots.groups[{}]", i), &robots.groups[i]});
    grouped += robots.groups[i].count;
  }
  if (grouped < robots.count) bodies.push_back({"robots", &robots});
  return bodies;
}

constexpr double kGroupCellsMax = 4.0;  // per communication radius: at most 100 cells per robot

}  // namespace

/// Surface gap m + (v + v′)(dt/γ + send_interval_max_s) plus both radii: the two robots drive
/// towards each other at full speed.
double least_communication_radius_m(const Mission& mission, const BodySpec& body) {
  const double braking_s = 1.0 / (mission.control.rate_hz * mission.safety.gap_share);
  double speed_max_mps = 0.0;
  for (const BodyInUse& other : bodies_in_use(mission.robots)) {
    speed_max_mps = std::max(speed_max_mps, other.spec->speed_max_mps);
  }
  return body.radius_m + largest_radius_m(mission.robots) + mission.safety.neighbour_margin_m +
         (body.speed_max_mps + speed_max_mps) * (braking_s + mission.link.send_interval_max_s);
}

/// The rules that the option tables declare by OptionSpec::at_most.
std::vector<BrokenRule> broken_rules(const std::string& section, const Components& components,
                                     const OptionValues& values) {
  Rules rules;
  for (const ComponentSpec& component : components) {
    const auto side = [&](std::string_view key) -> Side {
      const auto option =
          std::find_if(component.options.begin(), component.options.end(),
                       [&](const OptionSpec& candidate) { return candidate.key == key; });
      if (option == component.options.end()) return {};
      OptionValues fallback;
      fallback.set(key, option->fallback);
      const auto given = values.number(key);
      return {fmt::format("{}.{}", section, key),
              given ? *given : fallback.number(key).value_or(0.0)};
    };
    for (const OptionSpec& option : component.options) {
      if (!option.at_most.empty()) rules.at_most(side(option.key), side(option.at_most));
    }
  }
  return std::move(rules.broken);
}

namespace {

/// A radius below the least one of a body, which has its own radius or that of the link.
BrokenRule radius_too_small(const std::string& key, double radius_m, double least_m,
                            const std::string& body) {
  // Groups take the keys that they do not set from all robots.
  return {
      {key, body + ".radius_m", body + ".speed_max_mps", "robots.radius_m", "robots.speed_max_mps",
       "control.rate_hz", "safety.gap_share", "safety.neighbour_margin_m",
       "link.send_interval_max_s"},
      fmt::format("{} is {}; must be >= {:.4g}, from where on the safety filter needs to know a "
                  "robot",
                  key, radius_m, least_m)};
}

/// One rule for each radius: that of the link suits all bodies without one of their own.
void add_communication_radii(const Mission& mission, Rules& rules) {
  const double link_m = mission.link.communication_radius_m;
  double link_least_m = 0.0;
  std::string of;
  for (const BodyInUse& body : bodies_in_use(mission.robots)) {
    const double own_m = body.spec->communication_radius_m;
    const double least_m = least_communication_radius_m(mission, *body.spec);
    if (own_m > 0.0) {
      const std::string key = body.path + ".communication_radius_m";
      if (own_m < least_m) rules.broken.push_back(radius_too_small(key, own_m, least_m, body.path));
    } else if (least_m > link_least_m) {
      link_least_m = least_m;
      of = body.path;
    }
  }
  if (link_m >= link_least_m) return;
  rules.broken.push_back(radius_too_small("link.communication_radius_m", link_m, link_least_m, of));
}

}  // namespace

/// The structured binding names every member, so that a new section of Mission does not compile
/// until someone has looked at its rules.
std::vector<BrokenRule> broken_rules(const Mission& mission) {
  const auto& [name, world, robots, start, goal, goal_shape, planner, control, safety, link, timing,
               plan_clock, launcher, criteria, script] = mission;
  Rules rules;
  rules.at_most({"planner.speed_mps", planner.speed_mps},
                {"robots.speed_max_mps", robots.speed_max_mps});
  rules.at_most({"control.cruise_mps", control.cruise_mps},
                {"robots.speed_max_mps", robots.speed_max_mps});
  // Robots placed closer than the safety margins would start in violation of the filter's
  // constraints.
  rules.at_most({"safety.neighbour_margin_m", safety.neighbour_margin_m},
                {"robots.placement_gap_m", robots.placement_gap_m});
  rules.at_most({"safety.obstacle_margin_m", safety.obstacle_margin_m},
                {"robots.placement_gap_m", robots.placement_gap_m});
  // A neighbour that is at rest must not be forgotten between two of its state updates.
  rules.below({"link.send_interval_max_s", link.send_interval_max_s},
              {"timing.neighbour_forget_s", timing.neighbour_forget_s});
  // The gap between the margins is a hysteresis: a robot on a border must not join and leave at
  // every step.
  rules.below({"link.join_margin_m", link.join_margin_m},
              {"link.leave_margin_m", link.leave_margin_m});
  // With cells at least as wide as the radius, the area within it touches at most 3 × 3 cells.
  rules.at_most({"link.communication_radius_m", link.communication_radius_m},
                {"link.cell_size_m", link.cell_size_m});
  if (link.communication_radius_m > kGroupCellsMax * link.group_cell_size_m) {
    rules.add(
        {"link.group_cell_size_m", "link.communication_radius_m"},
        fmt::format("link.group_cell_size_m is {}; must be >= link.communication_radius_m / {}: a "
                    "robot listens to every cell within that radius",
                    link.group_cell_size_m, kGroupCellsMax));
  }
  rules.at_most({"timing.clock_skew_warn_s", timing.clock_skew_warn_s},
                {"timing.clock_skew_refuse_s", timing.clock_skew_refuse_s});
  rules.below({"plan_clock.lag_free_s", plan_clock.lag_free_s},
              {"plan_clock.lag_stop_s", plan_clock.lag_stop_s});
  rules.at_most({"plan_clock.lag_stop_s", plan_clock.lag_stop_s},
                {"plan_clock.hopeless_lag_s", plan_clock.hopeless_lag_s});
  // The loss of one heartbeat must not stop the swarm.
  if (timing.planner_silence_s * timing.heartbeat_hz < 2.0) {
    rules.add({"timing.planner_silence_s", "timing.heartbeat_hz"},
              fmt::format("timing.planner_silence_s is {}; must be >= {}, two heartbeats",
                          timing.planner_silence_s, 2.0 / timing.heartbeat_hz));
  }
  add_communication_radii(mission, rules);
  if (auto lack = lack_of_goal_room(mission)) {
    rules.add({"robots.count", "robots.radius_m"}, *std::move(lack));
  }
  return std::move(rules.broken);
}

}  // namespace swarm
