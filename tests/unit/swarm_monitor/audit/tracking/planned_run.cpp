// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planned_run.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace swarm::monitor {
namespace {

constexpr double kNodeTimes_s[] = {0.0, 30.0, 40.0, 70.0};
constexpr double kNodeX_m[] = {15.0, 52.5, 52.5, 90.0};
constexpr double kLaneY_m[] = {20.0, 40.0};

UtcTime utc(double time_s) {
  return UtcTime(std::chrono::seconds(1'800'000'000)) + from_seconds(time_s);
}

Gaussian round_gaussian(const Vec2& mean_m, double sigma_m) {
  return Gaussian::from_valid(mean_m, sigma_m * sigma_m * Mat2::Identity());
}

/// Mean x of both streams at τ.
double stream_x_m(double plan_time_s) {
  for (int k = 1; k < 4; ++k) {
    if (plan_time_s > kNodeTimes_s[k]) continue;
    const double share =
        (plan_time_s - kNodeTimes_s[k - 1]) / (kNodeTimes_s[k] - kNodeTimes_s[k - 1]);
    return kNodeX_m[k - 1] + std::max(share, 0.0) * (kNodeX_m[k] - kNodeX_m[k - 1]);
  }
  return kNodeX_m[3];
}

}  // namespace

double PlannedRun::plan_time_s(double time_s) {
  const double since_s = time_s - kStart_s;
  if (since_s < 20.0) return std::max(0.0, since_s);
  return since_s < 30.0 ? 20.0 + 0.5 * (since_s - 20.0) : since_s - 5.0;
}

Vec2 PlannedRun::reference_m(std::uint32_t robot, double plan_time_s) const {
  // Even ids above, odd ones below; in a stream evenly over the Gaussian, as a sunflower's seeds,
  // within its 97 % ellipse. Neighbours are 0.9 m apart at least.
  const double seeds = robots / 2.0;
  const double seed = robot / 2;
  const double radius_m = sigma_m * std::sqrt(-2.0 * std::log(1.0 - 0.97 * (seed + 0.5) / seeds));
  const double angle = seed * std::numbers::pi * (3.0 - std::sqrt(5.0));
  return Vec2(stream_x_m(plan_time_s), kLaneY_m[robot % 2]) +
         radius_m * Vec2(std::cos(angle), std::sin(angle));
}

FlowPlan PlannedRun::plan() const {
  std::vector<PlanNode> nodes;
  std::vector<PlanLeg> legs;
  for (const double y : kLaneY_m) {
    for (int k = 0; k < 4; ++k) {
      const auto node = static_cast<std::uint32_t>(nodes.size());
      nodes.push_back(
          {round_gaussian({kNodeX_m[k], y}, sigma_m), MissionTime(kNodeTimes_s[k]), 0.5});
      if (k > 0) legs.push_back({node - 1, node, 0.5});
    }
  }
  auto plan = FlowPlan::make(nodes, legs);
  EXPECT_TRUE(plan.has_value());
  return plan.value_or(FlowPlan{});
}

RecordedRun PlannedRun::make() const {
  RecordedRun run;
  Mission& mission = run.mission;
  auto world = World::make({{0, 0}, {130, 60}}, {Circle{{40, 30}, 1.5}});
  auto start = Mixture::make({{0.5, round_gaussian({kNodeX_m[0], kLaneY_m[0]}, sigma_m)},
                              {0.5, round_gaussian({kNodeX_m[0], kLaneY_m[1]}, sigma_m)}});
  auto goal = Mixture::make({{0.5, round_gaussian({kNodeX_m[3], kLaneY_m[0]}, sigma_m)},
                             {0.5, round_gaussian({kNodeX_m[3], kLaneY_m[1]}, sigma_m)}});
  EXPECT_TRUE(world && start && goal);
  mission.world = *world;
  mission.start = *start;
  mission.goal = *goal;
  mission.robots.count = robots;
  mission.planner.density_cap_per_m2 = cap_per_m2;
  mission.criteria = {.w2_ratio_max = 1.2,
                      .w2_half_ratio_max = 1.2,
                      .w2_end_ratio_max = 1.2,
                      .centre_lag_max_s = 2.0,
                      .lag_p90_max_s = 3.0,
                      .lag_p99_max_s = 5.0,
                      .clock_error_max_s = 0.3,
                      .reference_p50_max_m = 0.8,
                      .reference_p95_max_m = 2.0,
                      .reference_rms_max_m = 1.0,
                      // Counts in a disc scatter: 5 or 6 robots make up the cap.
                      .density_over_cap_p95_max = 0.35,
                      .density_over_cap_max = 0.5,
                      .planned_over_cap_max = 0.1,
                      .cvar_kept_share_min = 1.0,
                      .own_place_share_min = 0.95,
                      .path_ratio_max = 1.05,
                      .mission_over_plan_max_s = 10.0,
                      .arrival_spread_max_s = 5.0};
  run.plans.push_back({1, plan()});
  run.begin = utc(0.0);
  run.clock = {{utc(kStart_s), 1, 0.0, 1.0},
               {utc(kStart_s + 20.0), 1, 20.0, 0.5},
               {utc(kStart_s + 30.0), 1, 25.0, 1.0}};
  run.scenes.push_back(first_scene(1));
  for (std::uint32_t i = 0; i < robots; ++i) {
    TrackMaker maker(RobotId(i), run.begin);
    maker.take(robot_log::Header{
        .robot = RobotId(i), .robots = robots, .process_id = i + 1, .radius_m = 0.2});
    const bool falls_here = falls == i;
    const auto at = [&](double tau) {
      return position_m ? position_m(i, tau) : reference_m(i, tau);
    };
    const Vec2 last = at(plan_time_s(end_s));
    for (double t = 0.0; t <= (falls_here ? falls_at_s : end_s); t += kStep_s) {
      const double tau = plan_time_s(t);
      robot_log::Step step{
          .stamp = utc(t), .position_m = at(tau), .goal = static_cast<std::uint8_t>(i % 2)};
      const bool arrived = tau > 1.0 && (step.position_m - last).norm() < 0.3;
      step.mode = static_cast<std::uint8_t>(tau <= 0.0 ? RobotMode::kWaiting
                                            : arrived  ? RobotMode::kArrived
                                                       : RobotMode::kMoving);
      if (logs_references && t >= kStart_s) {
        const double logged = logged_plan_time_s ? logged_plan_time_s(tau) : tau;
        const Vec2 reference =
            logged_reference_m ? logged_reference_m(i, logged) : reference_m(i, logged);
        step.plan_version = 1;
        step.plan_time_s = static_cast<float>(logged);
        step.reference_x_m = static_cast<float>(reference.x());
        step.reference_y_m = static_cast<float>(reference.y());
      }
      maker.take(step);
    }
    if (!falls_here) maker.take(robot_log::Note{.stamp = utc(end_s), .code = "exit"});
    run.tracks.push_back(maker.finish());
  }
  return run;
}

}  // namespace swarm::monitor
