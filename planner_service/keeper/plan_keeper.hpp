// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "planner_service/keeper/clock_governor.hpp"
#include "planner_service/keeper/replan.hpp"
#include "planner_service/keeper/robot_watch.hpp"
#include "planner_service/planner.hpp"
#include "swarm_core/mission/scene_bodies.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/mission/phase.hpp"

namespace swarm::planner {

/// Keeps a plan for the scene as it is: the first one, and a new one when the scene changes, while
/// obstacles move, at the period of the planning method, when robots report that the last one
/// lacks, and where robots are stuck and the method finds another route. It also owns the plan's
/// clock. Pure: received messages and the time go in, plans and clock readings come out; the
/// program around it owns bus and files. One thread.
class PlanKeeper {
 public:
  /// `planner`: for this mission. \pre the mission outlives the keeper
  PlanKeeper(const Mission& mission, Planner planner, std::uint64_t seed, StageClock clock);

  /// The plan of the mission file. The same mission and seed give the same flow.
  Result<void> plan_first();

  /// The keeper is on the bus from now on. Timeouts for the scene and the robots begin here.
  void begin(SteadyTime now) { begun_at_ = now; }

  /// The robots have this reading: the clock does not show less from the next step on. It differs
  /// from the keeper's own where a command stopped the clock while the keeper planned.
  void on_published(const PlanClock& clock) { robots_have_ = clock; }

  void set_phase(MissionPhase phase) { phase_ = phase; }
  /// False if it is not newer than the present one.
  bool take_scene(Scene scene);
  /// \pre the id is below the number of robots
  void receive(const ReportedRobot& robot, bool moving, SteadyTime now) {
    if (robot.plan_version <= last_reachable(now)) {
      reported_version_ = std::max(reported_version_, robot.plan_version);
    }
    // A status sent before the robot failed may arrive after its body became an obstacle.
    if (!has_body(scene_, robot.robot)) robots_.receive(robot, moving, now);
  }

  /// An entry for the event log; the text is one line.
  struct Notice {
    bool warning = false;
    std::string code;
    std::string text;
  };
  /// What the program has to publish after a step.
  struct Step {
    bool publish = false;  ///< newest() is to be published, as version()
    /// A reading to publish: version or rate have changed, or the clock jumped.
    std::optional<PlanClock> clock{};
    std::vector<Notice> notices;
  };
  /// Call it often. It blocks while it plans.
  Step step(SteadyTime now, UtcTime utc);

  const Replan& newest() const { return newest_; }
  /// Of the newest published plan; 0: none. 1 is the mission's first plan; a plan made in flight
  /// has a later number than those that the robots follow, also those of an earlier planner.
  std::uint32_t version() const { return version_; }
  /// The plan's clock, as of the last step().
  PlanClock clock(UtcTime utc) const { return governor_.reading(utc); }
  const Scene& scene() const { return scene_; }
  const PlanningMethod& method() const { return planner_.method(); }
  /// Version of the scene newest() was made for.
  std::uint64_t planned_scene() const { return planned_scene_; }

 private:
  void keep_planned(SteadyTime now, UtcTime utc, Step& step);
  void avoid_jams(SteadyTime now, UtcTime utc, Step& step);
  void try_again(SteadyTime now, UtcTime utc, Step& step);
  bool is_step_due(SteadyTime now) const;
  bool is_in_flight(SteadyTime now) const;
  bool is_in_flight_elsewhere(SteadyTime now) const;
  bool is_waiting_for_robots(SteadyTime now) const;
  bool lacks_robots(SteadyTime now) const;
  bool is_waiting_for_returned(SteadyTime now);
  std::vector<ReportedRobot> placed(std::vector<ReportedRobot> robots) const;
  Result<Replan> plan_anew(const World& world, std::span<const ReportedRobot> robots);
  Result<Replan> plan_around_bodies(UtcTime utc, std::span<const ReportedRobot> robots, Step& step);
  void publish(SteadyTime now, std::uint64_t scene_version, Step& step);
  void keep_clock(SteadyTime now, UtcTime utc, Step& step);
  void catch_up(SteadyTime now);
  bool reports_lag(const ReportedRobot& robot) const;
  void report_clock(SteadyTime now, Step& step);

  const Mission& mission_;
  std::uint64_t seed_;
  StageClock clock_;
  Planner planner_;
  RobotWatch robots_;
  MissionPhase phase_ = MissionPhase::kReady;
  Scene scene_;
  bool scene_received_ = false;
  std::vector<RobotId> returned_{};          // bodies cleared since the last plan
  std::optional<SteadyTime> returned_at_{};  // the first of them
  // Period of planning anew while obstacles move, while the last attempt failed, and with robots
  // that reported late.
  static constexpr Duration kReplanPeriod = std::chrono::seconds(2);

  /// Robots refuse plans whose number a planner cannot have reached since its epoch, a thousand a
  /// second, of a new planner those from 11 000 on: a forged status must not lead there.
  std::uint32_t last_reachable(SteadyTime now) const {
    return static_cast<std::uint32_t>(
        std::min(10'000.0 + 1'000.0 * to_seconds(now - begun_at_), 4e9));
  }

  Replan newest_;
  std::vector<RobotId> planned_for_;    // by id; empty: newest_ begins at the mission's start
  std::uint32_t version_ = 0;           // 0 = nothing published
  std::uint32_t reported_version_ = 0;  // the latest that robots have followed, of any planner
  std::uint64_t planned_scene_ = 0;
  std::optional<std::uint64_t> failed_scene_{};  // scene whose failure was reported
  std::uint64_t bodies_left_out_ = 0;            // scene for which bodies-not-planned was reported
  SteadyTime begun_at_;
  SteadyTime tried_at_;  // to plan anew
  ClockGovernor governor_;
  PlanClock clock_reported_;  // of the last step that had one
  PlanClock robots_have_;     // as the robots received it
  SteadyTime judged_at_;      // the robots' lags
  SteadyTime full_rate_at_;   // when the clock last ran at full rate
  bool slow_reported_ = false;
  std::set<RobotId> hopeless_reported_;
};

}  // namespace swarm::planner
