// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "swarm_monitor/audit/clearance.hpp"
#include "swarm_monitor/audit/estimate_error.hpp"
#include "swarm_monitor/audit/recorded_run.hpp"
#include "swarm_monitor/audit/tracking/tracking.hpp"

namespace swarm::monitor {

/// Quantiles of the age of neighbours' states when controllers used them, over all states and
/// robots.
struct StateAge {
  double p50_ms = 0.0, p99_ms = 0.0, p999_ms = 0.0, max_ms = 0.0;
};

/// Quantiles over the robots of the time from the command of an emergency stop to rest.
struct StopLatency {
  double p50_ms = 0.0, p99_ms = 0.0, max_ms = 0.0;
};

/// The audit of one robot.
struct RobotAudit {
  RobotId robot{};
  bool lost = false;  ///< no robot log, or it ends without the note "exit"
  /// Not lost, and its last position lies in the 99 % ellipse of its goal, or, by intermittent
  /// diffusion, where the drawing's shape function is within the tolerance.
  bool arrived = false;
  std::optional<std::size_t> goal{};     ///< index into Mission::goal, of its last step
  std::optional<double> arrived_at_s{};  ///< time from which on it stayed arrived
  /// Length of the straight pieces between logged steps [m].
  double path_m = 0.0;
  /// Whether any logged position lies outside the world's rectangle.
  bool left_bounds = false;
  std::optional<double> stop_ms{};  ///< stamp of the stop it obeyed to its last change of position
};

/// What a run achieved, computed from its mission and robot logs alone.
struct Audit {
  std::vector<std::string> reasons;  ///< why the outcome is not "ok"; empty if it is
  std::vector<std::string> missing;  ///< evidence that the run lacks; each is a reason, too
  std::uint32_t robots = 0;
  std::uint32_t processes = 0;  ///< distinct process ids
  std::uint32_t arrived = 0;
  std::vector<std::uint32_t> arrived_per_goal;
  std::vector<RobotId> lost;
  std::uint32_t collisions_robot = 0;     ///< pairs that ever touched
  std::uint32_t collisions_obstacle = 0;  ///< robots that ever touched an obstacle
  std::uint32_t collisions_fallen = 0;    ///< pairs that touched after one of them had died
  std::optional<double> min_robot_gap_m;  ///< surface to surface; empty with fewer than two robots
  std::optional<double> min_obstacle_gap_m;
  std::optional<double> mean_path_m;       ///< over robots that are not lost
  std::optional<double> geodesic_bound_m;  ///< over their own first and last positions
  std::optional<double> path_ratio;
  std::optional<double> mission_s;  ///< first step in motion to the last arrival, else to the end
  std::optional<StateAge> state_age;
  std::optional<EstimateError> estimate;
  std::optional<double> states_hz;   ///< published by a robot, mean over the run
  std::optional<StopLatency> stop;   ///< empty if no robot was stopped
  double deadline_miss_ratio = 0.0;  ///< share of ticks that were missed or began over 20 ms late
  std::uint64_t refused_messages = 0;
  std::uint32_t outside_bounds = 0;  ///< robots that ever left the world's rectangle
  std::uint64_t damaged_records = 0;
  Tracking tracking{};  ///< how the swarm followed the published plans

  /// Measured by the launcher, copied from its summary: planning time of the first plan, time until
  /// all robots received their neighbours, CPU time of all processes, memory of the largest.
  std::optional<double> plan_ms, discovery_s, cpu_s, max_rss_mb;

  std::vector<RobotAudit> by_robot;  ///< not part of the JSON document
  /// The outcome: every robot arrived, none touched anything, and all criteria of the mission are
  /// met.
  bool ok() const { return reasons.empty(); }
};

/// A run with everything that the audit found in it, for the report.
struct AuditedRun {
  RecordedRun run;
  Clearance robots{};
  Clearance obstacles{};
  Audit audit{};
};

/// Judges a recorded run. A pure function: the same records give the same audit. Cost: see
/// robot_clearance() and measure_tracking(), which dominate.
AuditedRun audit_recorded(RecordedRun run);

/// Reads a run directory or a recording and audits it, with the launcher's measurements if its
/// summary is there.
Result<AuditedRun> audit_run_fully(const std::filesystem::path& from);

/// The same without the run's records. Fails (kEnvironment) if the run cannot be read.
Result<Audit> audit_run(const std::filesystem::path& from);

/// The audit as a JSON document; unknown values are null.
std::string to_json(const Audit& audit);

/// The audit in a few lines of text.
std::string to_text(const Audit& audit);

}  // namespace swarm::monitor
