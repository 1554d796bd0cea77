// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The watch beside a second implementation: a list of all statuses, searched anew for each answer.
#include <algorithm>

#include <gtest/gtest.h>

#include "planner_service/keeper/robot_watch.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::planner {
namespace {

using std::chrono::milliseconds;

constexpr std::uint32_t kRobots = 4;
constexpr Duration kForgetAfter = milliseconds(3000);
constexpr Duration kStuckAfter = milliseconds(4000);

struct Status {
  ReportedRobot robot;
  bool moving = false;
  SteadyTime at;
};

// Statuses of each robot since it was last forgotten, and the last reset of the timers.
struct History {
  std::vector<std::vector<Status>> of = std::vector<std::vector<Status>>(kRobots);
  std::vector<std::size_t> received_at_reset = std::vector<std::size_t>(kRobots, 0);
  SteadyTime reset_at;

  bool is_fresh(std::uint32_t i, SteadyTime now) const {
    return !of[i].empty() && now - of[i].back().at <= kForgetAfter;
  }

  // Since when the robot has made no progress: a status begins a stretch if the robot was at rest
  // before or then, or if it is 0.5 m or more from where the stretch began.
  bool is_stuck(std::uint32_t i) const {
    if (of[i].empty() || !of[i].back().moving) return false;
    std::size_t first = 0;
    for (std::size_t k = 1; k < of[i].size(); ++k) {
      const bool goes_on = of[i][k].moving && of[i][k - 1].moving &&
                           (of[i][k].robot.position_m - of[i][first].robot.position_m).norm() < 0.5;
      if (!goes_on) first = k;
    }
    const bool was_reset = first < received_at_reset[i];
    return of[i].back().at - (was_reset ? reset_at : of[i][first].at) >= kStuckAfter;
  }
};

std::vector<std::uint32_t> ids(const std::vector<ReportedRobot>& robots) {
  std::vector<std::uint32_t> all;
  for (const ReportedRobot& robot : robots) all.push_back(robot.robot.value());
  return all;
}

TEST(RobotWatch, AgreesWithASearchOfTheWholeHistory) {
  Rng rng(1);
  int stuck_answers = 0;
  int partial_answers = 0;
  for (int run = 0; run < 100; ++run) {
    RobotWatch watch(kRobots, kForgetAfter);
    History history;
    SteadyTime now{std::chrono::seconds(50)};
    for (int step = 0; step < 200; ++step) {
      now += milliseconds(rng() % 400);
      const auto i = static_cast<std::uint32_t>(rng() % kRobots);
      const std::uint64_t action = rng() % 100;
      if (action < 2) {
        watch.forget(RobotId(i));
        history.of[i].clear();
        history.received_at_reset[i] = 0;
      } else if (action < 4) {
        watch.reset_stuck_timers(now);
        history.reset_at = now;
        for (std::uint32_t r = 0; r < kRobots; ++r) {
          history.received_at_reset[r] = history.of[r].size();
        }
      } else {
        const bool moving = rng() % 20 != 0;
        // Most robots stay within 0.3 m; some statuses are elsewhere.
        const double reach_m = rng() % 25 == 0 ? 3.0 : 0.1;
        const Vec2 at_m(uniform(rng, -reach_m, reach_m), uniform(rng, -reach_m, reach_m));
        const ReportedRobot robot{.robot = RobotId(i), .position_m = at_m};
        watch.receive(robot, moving, now);
        history.of[i].push_back({robot, moving, now});
      }

      std::vector<std::uint32_t> fresh;
      std::vector<std::uint32_t> stuck;
      for (std::uint32_t r = 0; r < kRobots; ++r) {
        if (!history.is_fresh(r, now)) continue;
        fresh.push_back(r);
        if (history.is_stuck(r)) stuck.push_back(r);
      }
      ASSERT_EQ(ids(watch.fresh(now)), fresh) << "run " << run << ", step " << step;
      ASSERT_EQ(ids(watch.stuck(now, kStuckAfter)), stuck) << "run " << run << ", step " << step;
      ASSERT_EQ(watch.received_all(now), fresh.size() == kRobots);
      stuck_answers += stuck.empty() ? 0 : 1;
      partial_answers += fresh.size() < kRobots ? 1 : 0;
    }
  }
  EXPECT_GT(stuck_answers, 100);
  EXPECT_GT(partial_answers, 100);
}

TEST(RobotWatch, AnswersWithTheLastStatus) {
  RobotWatch watch(2, kForgetAfter);
  const SteadyTime now{std::chrono::seconds(9)};
  watch.receive({.robot = RobotId(1), .position_m = {1, 1}, .lag_s = 1.0}, true, now);
  watch.receive({.robot = RobotId(1), .position_m = {1, 2}, .lag_s = 2.0}, true, now);

  ASSERT_EQ(watch.fresh(now).size(), 1U);
  EXPECT_EQ(watch.fresh(now)[0].position_m, Vec2(1, 2));
  EXPECT_EQ(watch.fresh(now)[0].lag_s, 2.0);
  EXPECT_FALSE(watch.received_all(now)) << "robot 0 has not reported";
}

}  // namespace
}  // namespace swarm::planner
