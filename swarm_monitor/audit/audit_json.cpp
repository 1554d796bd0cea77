// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "swarm_monitor/audit/audit.hpp"
#include "swarm_monitor/audit/tracking/tracking_json.hpp"

namespace swarm::monitor {
namespace {

using Json = nlohmann::ordered_json;

/// A value that was not measured becomes null, which readers can distinguish from zero.
Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

std::string counted(std::uint32_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string metres(const std::optional<double>& value, const char* none) {
  return value ? fmt::format("{:.3f} m", *value) : none;
}

}  // namespace

/// The keys are an interface: scripts and tests read them.
std::string to_json(const Audit& audit) {
  Json lost = Json::array();
  for (const RobotId id : audit.lost) lost.push_back(id.value());
  Json age = nullptr;
  if (audit.state_age) {
    age = {{"p50", audit.state_age->p50_ms},
           {"p99", audit.state_age->p99_ms},
           {"p999", audit.state_age->p999_ms},
           {"max", audit.state_age->max_ms}};
  }
  Json estimate = nullptr;
  if (audit.estimate) {
    estimate = {{"p50", audit.estimate->p50_cm},
                {"p99", audit.estimate->p99_cm},
                {"p999", audit.estimate->p999_cm},
                {"max", audit.estimate->max_cm}};
  }
  Json stop = nullptr;
  if (audit.stop) {
    stop = {{"p50", audit.stop->p50_ms}, {"p99", audit.stop->p99_ms}, {"max", audit.stop->max_ms}};
  }
  const Json json = {{"outcome", audit.ok() ? "ok" : "criteria_not_met"},
                     {"reasons", audit.reasons},
                     {"missing", audit.missing},
                     {"robots", audit.robots},
                     {"processes", audit.processes},
                     {"arrived", audit.arrived},
                     {"arrived_per_goal", audit.arrived_per_goal},
                     {"lost", lost},
                     {"collisions_robot", audit.collisions_robot},
                     {"collisions_obstacle", audit.collisions_obstacle},
                     {"collisions_fallen", audit.collisions_fallen},
                     {"min_robot_gap_m", number(audit.min_robot_gap_m)},
                     {"min_obstacle_gap_m", number(audit.min_obstacle_gap_m)},
                     {"mean_path_m", number(audit.mean_path_m)},
                     {"geodesic_bound_m", number(audit.geodesic_bound_m)},
                     {"path_ratio", number(audit.path_ratio)},
                     {"mission_s", number(audit.mission_s)},
                     {"state_age_ms", age},
                     {"belief_error_cm", estimate},
                     {"states_hz", number(audit.states_hz)},
                     {"stop_latency_ms", stop},
                     {"deadline_miss_ratio", audit.deadline_miss_ratio},
                     {"refused_messages", audit.refused_messages},
                     {"outside_bounds", audit.outside_bounds},
                     {"damaged_records", audit.damaged_records},
                     {"tracking", tracking_json(audit.tracking)},
                     {"plan_ms", number(audit.plan_ms)},
                     {"discovery_s", number(audit.discovery_s)},
                     {"cpu_s", number(audit.cpu_s)},
                     {"max_rss_mb", number(audit.max_rss_mb)}};
  return json.dump(2) + "\n";
}

/// The same numbers as to_json() in one line each, units included. Lines of values that were not
/// measured are left out.
std::string to_text(const Audit& audit) {
  std::string text =
      fmt::format("{}: {} of {} robots arrived, {} lost, {}\n",
                  audit.ok() ? "ok" : "criteria not met", audit.arrived, audit.robots,
                  audit.lost.size(), counted(audit.processes, "process", "processes"));
  for (const std::string& reason : audit.reasons) text += fmt::format("  - {}\n", reason);
  text += fmt::format("  per goal         {}\n", fmt::join(audit.arrived_per_goal, ", "));
  text +=
      fmt::format("  contacts         {} between robots, {} with dead ones, {} with obstacles\n",
                  audit.collisions_robot, audit.collisions_fallen, audit.collisions_obstacle);
  text +=
      fmt::format("  smallest gaps    {} between robots, {} to obstacles\n",
                  metres(audit.min_robot_gap_m, "none"), metres(audit.min_obstacle_gap_m, "none"));
  if (audit.mean_path_m) {
    text += fmt::format("  mean path        {:.2f} m", *audit.mean_path_m);
    if (audit.path_ratio) {
      text += fmt::format(", {:.3f} times the geodesic bound {:.2f} m", *audit.path_ratio,
                          *audit.geodesic_bound_m);
    }
    text += "\n";
  }
  if (audit.mission_s) text += fmt::format("  mission time     {:.1f} s\n", *audit.mission_s);
  text += tracking_text(audit.tracking);
  if (audit.stop) {
    text += fmt::format("  stop to rest     {:.0f} ms (p50), {:.0f} (p99), {:.0f} (max)\n",
                        audit.stop->p50_ms, audit.stop->p99_ms, audit.stop->max_ms);
  }
  if (audit.state_age) {
    text += fmt::format("  age of states    {:.1f} ms (p50), {:.1f} (p99), {:.1f} (max)\n",
                        audit.state_age->p50_ms, audit.state_age->p99_ms, audit.state_age->max_ms);
  }
  if (audit.estimate) {
    text += fmt::format("  estimate error   {:.1f} cm (p50), {:.1f} (p99), {:.1f} (max)\n",
                        audit.estimate->p50_cm, audit.estimate->p99_cm, audit.estimate->max_cm);
  }
  if (audit.states_hz) {
    text += fmt::format("  states           {:.2f} a second published by each robot\n",
                        *audit.states_hz);
  }
  text += fmt::format("  late steps       {:.3f} %, refused messages {}\n",
                      100.0 * audit.deadline_miss_ratio, audit.refused_messages);
  return text;
}

}  // namespace swarm::monitor
