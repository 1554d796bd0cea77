// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "swarm_core/plan/planning_record.hpp"
#include "swarm_core/robot_log/record.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/plan_clock.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/mission/phase.hpp"

namespace swarm::monitor {

/// A control step of a robot: its position, and its mode from then on.
struct TrackPoint {
  double time_s = 0.0;  ///< since RecordedRun::begin
  Vec2 position_m = Vec2::Zero();
  bool is_rest = false;  ///< no step: where the body comes to rest after the step before
  RobotMode mode = RobotMode::kWaiting;
  std::uint8_t goal = robot_log::Step::kNoGoal;
  std::uint16_t neighbours = 0;    ///< in its neighbour table
  std::uint32_t plan_version = 0;  ///< of the plan it follows in time; 0: none
  float plan_time_s = 0.0F;        ///< τ of that plan as the robot has it
  float reference_x_m = 0.0F;      ///< x_ref(τ) as the robot has it
  float reference_y_m = 0.0F;

  Vec2 reference_m() const { return {reference_x_m, reference_y_m}; }
};

/// Position that a robot estimated for one of its neighbours.
struct EstimatePoint {
  double time_s = 0.0;  ///< since RecordedRun::begin
  RobotId neighbour;
  Vec2 position_m = Vec2::Zero();
};

/// Contents of one robot's log. Between two points a robot moves in a straight line at constant
/// speed, also from the end of one incarnation of its process to the begin of the next.
struct Track {
  RobotId robot{};
  double radius_m = 0.0;
  std::vector<TrackPoint> points{};  ///< times strictly increasing
  std::vector<EstimatePoint> estimates{};
  std::vector<std::uint32_t> processes{};  ///< one per incarnation
  bool ended_gracefully = false;           ///< the last incarnation noted "exit"
  /// The body of a dead robot stays at the last point until this time; a time before the last
  /// point means that there is no body. Set by lay_fallen_bodies().
  double body_until_s = 0.0;
  std::string unreadable{};        ///< why there is no robot log; empty if there is one
  std::uint64_t damaged = 0;       ///< unreadable stretches of the file, and steps back in time
  std::uint64_t lost = 0;          ///< records that the numbering of the log lacks
  std::uint64_t late_ticks = 0;    ///< that began late, and that were missed
  std::uint64_t missed_ticks = 0;  ///< that have no step
  std::uint64_t refused = 0;       ///< messages, over all incarnations
  Histogram state_age{};           ///< over all incarnations
  std::uint64_t states_sent = 0;   ///< over all incarnations
  std::vector<robot_log::Note> notes{};
};

/// A line of events.jsonl.
struct RunEvent {
  double time_s = 0.0;
  std::string source, severity, code, text;
  std::optional<double> mission_time_s{};  ///< only in a live run, and only where it is known
};

/// A plan as it was published.
struct PublishedPlan {
  std::uint32_t version = 0;  ///< 1 is the first
  FlowPlan plan;
  double excess_m = 0.0;  ///< largest violation of its own constraints [m]
};

/// A run as it was read. Audits and reports are pure functions of it.
struct RecordedRun {
  Mission mission;
  std::vector<PublishedPlan> plans{};  ///< by ascending version
  UtcTime begin{};                     ///< first step in any robot log
  std::vector<Track> tracks{};         ///< by robot id, mission.robots.count of them
  std::vector<RunEvent> events{};
  std::vector<Scene> scenes{};               ///< the first as in the mission file
  std::string launcher_summary{};            ///< text of summary.json
  std::vector<PlanClock> clock{};            ///< the plan's clock as published; stamps ascend
  std::optional<PlanningRecord> planning{};  ///< what the planning method guarantees, if recorded
  std::vector<std::string> gaps{};           ///< what a recording lacks, a sentence each

  /// The final goal of the swarm: that of the newest scene with a goal, else the mission's.
  const Mixture& goal() const;
  /// The plan that the mission started with; null if none was published.
  const FlowPlan* first_plan() const { return plans.empty() ? nullptr : &plans.front().plan; }
  /// Largest constraint violation of all plans.
  double plan_excess_m() const;
};

/// Reads a run directory, or a recording of one. Fails (kEnvironment) if there is no readable
/// mission or no robot log at all. What single robots lack is noted in their tracks; a missing
/// plan, clock or event log is no error.
Result<RecordedRun> read_run(const std::filesystem::path& from);

/// Builds a track from the records of one robot log, with times since `origin` [s].
class TrackMaker {
 public:
  /// `period`: of control; 0: missed ticks are not counted.
  TrackMaker(RobotId robot, UtcTime origin, Duration period = {})
      : origin_(origin), period_(period) {
    track_.robot = robot;
  }

  void add(const robot_log::Record& record);
  void take(const robot_log::Header& header);
  void take(const robot_log::Step& step);
  void take(const robot_log::Estimate& estimate);
  void take(const robot_log::LinkStats& stats) { incarnation_ = stats; }
  void take(const robot_log::Note& note);
  /// Closes the last incarnation and hands over the track; the maker is empty afterwards.
  Track finish();

 private:
  void close_incarnation();
  void let_body_come_to_rest();

  UtcTime origin_;
  Duration period_;
  Track track_{};
  robot_log::LinkStats incarnation_{};  // newest counters of the current incarnation
  robot_log::Step last_step_{};         // of the current incarnation
};

}  // namespace swarm::monitor
