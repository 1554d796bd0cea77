// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/audit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <nlohmann/json.hpp>

#include "swarm_core/metrics/geodesic_bound.hpp"
#include "swarm_monitor/audit/evidence.hpp"
#include "swarm_monitor/audit/fallen_bodies.hpp"
#include "swarm_monitor/audit/quantile.hpp"
#include "swarm_monitor/audit/verdict.hpp"

namespace swarm::monitor {
namespace {

/// Time of the first point of the robot's last stay in mode "arrived" [s since the begin of the
/// run]; empty if its last stay ended. Only moving or waiting ends a stay: a hold or a stop leaves
/// the robot where it is.
std::optional<double> stays_arrived_from(const Track& track) {
  std::optional<double> since;
  for (const TrackPoint& point : track.points) {
    if (point.mode == RobotMode::kArrived) {
      if (!since) since = point.time_s;
    } else if (point.mode == RobotMode::kMoving || point.mode == RobotMode::kWaiting) {
      since.reset();
    }
  }
  return since;
}

/// Time from the stamp of the emergency stop, which the robot logged as the cause of its mode
/// "stopped", to the last change of its position [ms]. Both stamps are wall clock times, on several
/// hosts of different clocks, so that a negative difference counts as 0.
std::optional<double> stop_latency_ms(const Track& track, UtcTime begin) {
  const auto stopped =
      std::find_if(track.notes.begin(), track.notes.end(), [](const robot_log::Note& note) {
        return note.code == "mode" && note.text == to_string(RobotMode::kStopped) &&
               note.caused != UtcTime{};
      });
  if (stopped == track.notes.end() || track.points.empty()) return std::nullopt;
  const Vec2& rest_m = track.points.back().position_m;
  const auto moving =
      // The last point at which the robot was not yet at its final position; the point after it is
      // the first at rest.
      std::find_if(track.points.rbegin(), track.points.rend(),
                   [&](const TrackPoint& point) { return point.position_m != rest_m; });
  if (moving == track.points.rbegin() || moving == track.points.rend()) return 0.0;
  const double at_rest_s = std::prev(moving)->time_s;
  return std::max(0.0, 1e3 * (at_rest_s - to_seconds(stopped->caused - begin)));
}

/// Whether a position counts as arrived: inside the 99 % ellipse of component `goal`, or within the
/// tolerance of the shape function [m²] if the mission fills a drawing.
bool is_at_goal(const RecordedRun& run, std::size_t goal, const Vec2& position_m) {
  const std::optional<double>& tolerance_m2 = run.mission.control.shape_tolerance_m2;
  if (tolerance_m2 && run.mission.goal_shape != nullptr) {
    return run.mission.goal_shape->at(position_m).energy_m2 <= *tolerance_m2;
  }
  return run.goal().components()[goal].gaussian.contains_99(position_m);
}

/// Judges one robot by its own track. A robot without a point, or whose log does not end with the
/// note "exit", is lost and cannot have arrived.
RobotAudit audit_robot(const Track& track, const RecordedRun& run) {
  RobotAudit result{.robot = track.robot};
  result.lost = !track.ended_gracefully || track.points.empty();
  if (track.points.empty()) return result;
  // The sum of the straight pieces between logged steps, at most the length of the driven path.
  for (std::size_t k = 1; k < track.points.size(); ++k) {
    result.path_m += (track.points[k].position_m - track.points[k - 1].position_m).norm();
  }
  result.left_bounds =
      std::any_of(track.points.begin(), track.points.end(), [&](const TrackPoint& point) {
        return !run.mission.world.bounds_m().contains(point.position_m);
      });
  const TrackPoint& last = track.points.back();
  const auto& goals = run.goal().components();
  if (last.goal < goals.size()) result.goal = last.goal;
  result.arrived = !result.lost && result.goal && is_at_goal(run, *result.goal, last.position_m);
  result.arrived_at_s = stays_arrived_from(track);
  result.stop_ms = stop_latency_ms(track, run.begin);
  return result;
}

/// Duration of the mission: from the first step in motion of any robot to the last arrival, or to
/// the last step of all if a robot did not arrive. Empty if no robot moved.
std::optional<double> mission_duration_s(const RecordedRun& run, const Audit& audit) {
  std::optional<double> first_motion;
  double last_step = 0.0;
  double last_arrival = 0.0;
  bool all_arrived = true;
  for (std::size_t i = 0; i < run.tracks.size(); ++i) {
    const Track& track = run.tracks[i];
    for (const TrackPoint& point : track.points) {
      if (point.mode != RobotMode::kMoving) continue;
      first_motion = std::min(first_motion.value_or(point.time_s), point.time_s);
      break;
    }
    if (!track.points.empty()) last_step = std::max(last_step, track.points.back().time_s);
    const RobotAudit& robot = audit.by_robot[i];
    all_arrived = all_arrived && robot.arrived && robot.arrived_at_s;
    last_arrival = std::max(last_arrival, robot.arrived_at_s.value_or(0.0));
  }
  if (!first_motion) return std::nullopt;
  return std::max(0.0, (all_arrived ? last_arrival : last_step) - *first_motion);
}

/// Audits every robot and adds up what counts over the whole swarm: arrivals per goal, lost robots,
/// late steps, state rate and the quantiles of stop latency and state age. O(steps).
void count_robots(const RecordedRun& run, Audit& audit) {
  std::set<std::uint32_t> processes;
  std::uint64_t steps = 0;
  std::uint64_t late = 0;
  std::uint64_t states_sent = 0;
  double recorded_s = 0.0;
  std::vector<double> stop_ms;
  Histogram age;
  audit.robots = static_cast<std::uint32_t>(run.tracks.size());
  // A histogram of all robots' state ages: quantiles of the swarm, not a mean of the robots'
  // quantiles.
  audit.arrived_per_goal.assign(run.goal().components().size(), 0);
  for (const Track& track : run.tracks) {
    const RobotAudit robot = audit_robot(track, run);
    if (robot.lost) audit.lost.push_back(robot.robot);
    if (robot.arrived) {
      ++audit.arrived;
      ++audit.arrived_per_goal[*robot.goal];
    }
    if (robot.left_bounds) ++audit.outside_bounds;
    if (robot.stop_ms) stop_ms.push_back(*robot.stop_ms);
    audit.by_robot.push_back(robot);
    processes.insert(track.processes.begin(), track.processes.end());
    steps += track.points.size() + track.missed_ticks;
    late += track.late_ticks;
    states_sent += track.states_sent;
    // The time that a robot was recorded, so that the rate is per robot and independent of the
    // length of the run.
    if (!track.points.empty()) {
      recorded_s += track.points.back().time_s - track.points.front().time_s;
    }
    age.merge(track.state_age);
    audit.refused_messages += track.refused;
    audit.damaged_records += track.damaged;
  }
  audit.processes = static_cast<std::uint32_t>(processes.size());
  if (steps > 0) audit.deadline_miss_ratio = static_cast<double>(late) / static_cast<double>(steps);
  if (recorded_s > 0.0) audit.states_hz = static_cast<double>(states_sent) / recorded_s;
  if (!stop_ms.empty()) {
    audit.stop = StopLatency{.p50_ms = quantile(stop_ms, 0.5),
                             .p99_ms = quantile(stop_ms, 0.99),
                             .max_ms = quantile(stop_ms, 1.0)};
  }
  if (age.count() > 0) {
    const auto ms = [](std::int64_t us) { return static_cast<double>(us) / 1000.0; };
    audit.state_age = StateAge{.p50_ms = ms(age.quantile_us(0.5)),
                               .p99_ms = ms(age.quantile_us(0.99)),
                               .p999_ms = ms(age.quantile_us(0.999)),
                               .max_ms = ms(age.max_us())};
  }
}

/// Mean path of the robots that are not lost, and its ratio to the geodesic bound: the mean length
/// of the shortest obstacle-avoiding paths from their first to their last positions, assigned
/// optimally. Only obstacles that stand throughout the run enter the bound, which would otherwise
/// not be one.
void measure_paths(const RecordedRun& run, Audit& audit) {
  std::vector<Vec2> starts, ends;
  double sum = 0.0;
  for (std::size_t i = 0; i < run.tracks.size(); ++i) {
    if (audit.by_robot[i].lost) continue;
    starts.push_back(run.tracks[i].points.front().position_m);
    ends.push_back(run.tracks[i].points.back().position_m);
    sum += audit.by_robot[i].path_m;
  }
  if (starts.empty()) return;
  audit.mean_path_m = sum / static_cast<double>(starts.size());
  const double bound = geodesic_bound_m(lasting_world(run.mission.world, run.scenes),
                                        run.mission.robots.radius_m, starts, ends);
  if (!std::isfinite(bound)) return;
  audit.geodesic_bound_m = bound;
  if (bound > 0.0) audit.path_ratio = *audit.mean_path_m / bound;
}

/// The parts of tracking that need the audit's arrivals: their spread (5 % to 95 %) and the mission
/// time beyond the duration of the first plan.
void measure_arrivals(Audit& audit) {
  std::vector<double> arrivals_s;
  for (const RobotAudit& robot : audit.by_robot) {
    if (robot.arrived && robot.arrived_at_s) arrivals_s.push_back(*robot.arrived_at_s);
  }
  Tracking& tracking = audit.tracking;
  if (!arrivals_s.empty()) {
    tracking.arrival_spread_s = quantile(arrivals_s, 0.95) - quantile(arrivals_s, 0.05);
  }
  if (tracking.plan_s && audit.mission_s) {
    tracking.mission_over_plan_s = *audit.mission_s - *tracking.plan_s;
  }
}

/// Copies the four numbers that only the launcher can measure (planning time, discovery, CPU,
/// memory) from its summary. The audit recomputes everything else and ignores the summary's other
/// keys.
void carry_over(const std::string& summary, Audit& audit) {
  const auto json = nlohmann::json::parse(summary, nullptr, false);
  if (!json.is_object()) return;
  const auto take = [&](const char* key, std::optional<double>& value) {
    if (const auto it = json.find(key); it != json.end() && it->is_number())
      value = it->get<double>();
  };
  take("plan_ms", audit.plan_ms);
  take("discovery_s", audit.discovery_s);
  take("cpu_s", audit.cpu_s);
  take("max_rss_mb", audit.max_rss_mb);
}

}  // namespace

/// The order of the steps matters: bodies of dead robots must be laid before the clearances are
/// computed, and tracking must be measured before the reasons are collected.
AuditedRun audit_recorded(RecordedRun recorded) {
  AuditedRun audited{.run = std::move(recorded)};
  lay_fallen_bodies(audited.run);
  const RecordedRun& run = audited.run;
  audited.robots = robot_clearance(run.tracks);
  audited.obstacles =
      obstacle_clearance(run.tracks, world_phases(run.mission.world, run.scenes), run.begin);
  Audit& audit = audited.audit;
  count_robots(run, audit);
  measure_paths(run, audit);
  audit.mission_s = mission_duration_s(run, audit);
  audit.estimate = estimate_error(run.tracks);
  audit.tracking = measure_tracking(run);
  measure_arrivals(audit);
  audit.collisions_robot = static_cast<std::uint32_t>(audited.robots.contacts.size());
  audit.collisions_fallen = static_cast<std::uint32_t>(audited.robots.fallen_contacts.size());
  std::set<std::uint32_t> touching;
  for (const Approach& contact : audited.obstacles.contacts) touching.insert(contact.robot);
  audit.collisions_obstacle = static_cast<std::uint32_t>(touching.size());
  // A gap is infinite where there was nothing to come near to; JSON has no infinity, so it becomes
  // an empty value.
  const auto known = [](double gap) {
    return std::isfinite(gap) ? std::optional<double>(gap) : std::nullopt;
  };
  audit.min_robot_gap_m = known(audited.robots.nearest.gap_m);
  audit.min_obstacle_gap_m = known(audited.obstacles.nearest.gap_m);
  audit.missing = missing_evidence(run);
  audit.reasons = reasons_for_failure(audited);
  return audited;
}

Result<AuditedRun> audit_run_fully(const std::filesystem::path& from) {
  auto run = read_run(from);
  if (!run) return tl::unexpected(run.error());
  AuditedRun audited = audit_recorded(std::move(*run));
  carry_over(audited.run.launcher_summary, audited.audit);
  return audited;
}

Result<Audit> audit_run(const std::filesystem::path& from) {
  auto audited = audit_run_fully(from);
  if (!audited) return tl::unexpected(audited.error());
  return std::move(audited->audit);
}

}  // namespace swarm::monitor
