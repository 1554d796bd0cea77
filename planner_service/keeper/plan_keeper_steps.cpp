// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// When to plan from the robots' positions, and the state of the robots at that time.
#include <algorithm>

#include "planner_service/groups/robot_groups.hpp"
#include "planner_service/keeper/plan_keeper.hpp"
#include "swarm_core/mission/placement.hpp"
#include "swarm_core/plan/flow_draw.hpp"

namespace swarm::planner {
namespace {

// A planner that plans with robots that have returned waits this long for their statuses; one that
// was restarted in flight twice as long, until robots have found it.
constexpr Duration kReportTimeout = std::chrono::milliseconds(1500);
// With a plan at each period a status may refer to an earlier plan, up to this many before.
constexpr std::uint32_t kPlansBack = 3;

}  // namespace

/// A method with a period plans anew from where the robots are, until the last one has arrived.
bool PlanKeeper::is_step_due(SteadyTime now) const {
  const std::optional<Duration> period = method().replan_period();
  if (!period || phase_ != MissionPhase::kRunning || now - tried_at_ < *period) return false;
  const std::vector<ReportedRobot> robots = robots_.fresh(now);
  return std::any_of(robots.begin(), robots.end(),
                     [](const ReportedRobot& r) { return !r.arrived; });
}

/// The robots have left their start: the mission runs, or did for a planner before this one.
bool PlanKeeper::is_in_flight(SteadyTime now) const {
  return phase_ != MissionPhase::kReady || is_in_flight_elsewhere(now);
}

/// The robots follow a later plan than the first, which a planner before this one made.
bool PlanKeeper::is_in_flight_elsewhere(SteadyTime now) const {
  if (version_ > 0) return false;
  const std::vector<ReportedRobot> received = robots_.fresh(now);
  return std::any_of(received.begin(), received.end(),
                     [](const ReportedRobot& r) { return r.plan_version > 1; });
}

/// Whether robots may still report for the first time after a start of the planner.
bool PlanKeeper::is_waiting_for_robots(SteadyTime now) const {
  if (now - begun_at_ >= 2 * kReportTimeout) return false;
  for (std::uint32_t id = 0; id < mission_.robots.count; ++id) {
    if (!robots_.is_received(RobotId(id), now) && !has_body(scene_, RobotId(id))) return true;
  }
  return false;
}

/// Whether robots have reported that the plan in force, made from the positions of the others, does
/// not count: it would share out the goals as if they did not exist.
bool PlanKeeper::lacks_robots(SteadyTime now) const {
  if (phase_ != MissionPhase::kRunning || planned_for_.empty()) return false;
  if (planned_for_.size() == mission_.robots.count || now - tried_at_ < kReplanPeriod) return false;
  const std::vector<ReportedRobot> robots = robots_.fresh(now);
  return std::ranges::any_of(robots, [this](const ReportedRobot& robot) {
    return !std::ranges::binary_search(planned_for_, robot.robot);
  });
}

/// The launcher clears the body of a robot as soon as it receives the robot; here its status may
/// arrive later. A plan without it would share out the goals as if it did not exist.
bool PlanKeeper::is_waiting_for_returned(SteadyTime now) {
  if (returned_.empty()) return false;
  if (!returned_at_) returned_at_ = now;
  return now - *returned_at_ < kReportTimeout && std::ranges::any_of(returned_, [&](RobotId robot) {
           return !has_body(scene_, robot) && !robots_.is_received(robot, now);
         });
}

/// Adds each robot's leg and goal in the plan in force: its share and the plan time determine both.
std::vector<ReportedRobot> PlanKeeper::placed(std::vector<ReportedRobot> robots) const {
  if (!method().traits().uses_positions || version_ == 0) return robots;
  const FlowPlan& plan = newest_.planned.plan;
  const Mixture& goal = scene_.goal ? *scene_.goal : mission_.goal;
  const MissionTime at(governor_.plan_time_s());
  for (ReportedRobot& robot : robots) {
    const std::uint32_t id = robot.robot.value();
    double share = stratified_share(id, mission_.robots.count);
    std::size_t source = 0;
    if (newest_.entries.empty()) {
      source = draw_source(plan, share);
    } else {
      if (newest_.entries[id].source == PlanEntry::kAnywhere) continue;
      source = newest_.entries[id].source;
      share = newest_.entries[id].draw_share();
    }
    const FlowPosition place = position_in_flow(plan, source, share, at);
    robot.goal = component_at(goal, plan.nodes()[place.sink].gaussian.mean_m());
    robot.leg = place.leg;
  }
  return robots;
}

/// Whether the lag of a robot counts. A lag refers to the plan the robot follows. Plans made at a
/// period continue each other, so that there a status of a few plans before counts as well.
bool PlanKeeper::reports_lag(const ReportedRobot& robot) const {
  if (robot.plan_version > version_) return false;
  return version_ - robot.plan_version <= (method().replan_period() ? kPlansBack : 0);
}

}  // namespace swarm::planner
