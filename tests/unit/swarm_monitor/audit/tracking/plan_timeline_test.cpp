// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/plan_timeline.hpp"

#include <gtest/gtest.h>

#include "tests/unit/swarm_monitor/audit/tracking/planned_run.hpp"

namespace swarm::monitor {
namespace {

/// Plan 1 from second 1, plan 2 from second 20 on; plan 3, from second 50 on, was not recorded.
RecordedRun two_plans() {
  RecordedRun run;
  run.begin = UtcTime(std::chrono::seconds(1000));
  run.plans = {{1, PlannedRun{}.plan()}, {2, PlannedRun{}.plan()}};
  const auto at = [&](double s) { return run.begin + from_seconds(s); };
  run.clock = {{at(1.0), 1, 0.0, 1.0},   {at(11.0), 1, 10.0, 0.25}, {at(20.0), 2, 0.0, 1.0},
               {at(30.0), 2, 10.0, 0.0}, {at(40.0), 2, 10.0, 1.0},  {at(50.0), 3, 0.0, 1.0}};
  return run;
}

TEST(PlanTimeline, ReportsWhichPlanIsInForceAndItsTime) {
  const RecordedRun run = two_plans();
  const PlanTimeline timeline(run);

  EXPECT_FALSE(timeline.at(0.9));
  const std::vector<std::array<double, 3>> expected{{1.0, 1, 0.0},   {6.0, 1, 5.0},
                                                    {15.0, 1, 11.0}, {20.0, 2, 0.0},
                                                    {35.0, 2, 10.0}, {45.0, 2, 15.0}};
  for (const auto& [time_s, version, plan_time_s] : expected) {
    const auto moment = timeline.at(time_s);
    ASSERT_TRUE(moment) << time_s;
    EXPECT_EQ(moment->published->version, version) << time_s;
    EXPECT_NEAR(moment->plan_time_s, plan_time_s, 1e-9) << time_s;
  }
  EXPECT_FALSE(timeline.at(50.0)) << "a plan that was not recorded";
}

TEST(PlanTimeline, LeavesOutMomentsAtWhichThePlanIsOver) {
  RecordedRun run = two_plans();
  run.clock.resize(1);  // plan 1 of 70 s, from second 1 on
  const PlanTimeline timeline(run);

  const auto moments = timeline.moments(0.0, 100.0, 1.0);

  ASSERT_EQ(moments.size(), 71U);
  EXPECT_EQ(moments.front().time_s, 1.0);
  EXPECT_EQ(moments.back().time_s, 71.0);
}

TEST(PlanTimeline, ThinsEvenlyAndKeepsTheLast) {
  RecordedRun run = two_plans();
  run.clock.resize(1);
  const PlanTimeline timeline(run);
  const auto moments = timeline.moments(1.0, 60.0, 1.0);

  const auto few = thinned(moments, 7);

  ASSERT_EQ(few.size(), 7U);
  EXPECT_EQ(few.back().time_s, 60.0);
  for (std::size_t k = 1; k < few.size(); ++k) {
    EXPECT_NEAR(few[k].time_s - few[k - 1].time_s, 60.0 / 7.0, 1.0);
  }
  EXPECT_EQ(thinned(moments, 100).size(), moments.size());
}

}  // namespace
}  // namespace swarm::monitor
