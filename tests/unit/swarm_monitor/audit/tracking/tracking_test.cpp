// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/tracking.hpp"

#include <gtest/gtest.h>

#include "swarm_monitor/audit/tracking/tracking_json.hpp"
#include "swarm_monitor/report/report.hpp"
#include "tests/unit/swarm_monitor/audit/tracking/planned_run.hpp"
#include "tests/unit/swarm_monitor/well_formed.hpp"

namespace swarm::monitor {
namespace {

TEST(Tracking, IsTheSameEveryTime) {
  const RecordedRun run = PlannedRun{}.make();

  EXPECT_EQ(tracking_json(measure_tracking(run)), tracking_json(measure_tracking(run)));
}

TEST(Tracking, NeedsNeitherClockNorPlan) {
  RecordedRun run = PlannedRun{}.make();
  run.clock.clear();
  run.plans.clear();

  const Tracking tracking = measure_tracking(run);

  EXPECT_FALSE(tracking.w2 || tracking.centre_lag_s || tracking.own.lag || tracking.density);
  EXPECT_TRUE(tracking.ending.to_goal) << "the goal is the mission's";
  EXPECT_EQ(tracking_json(tracking).size(), 16U);
  EXPECT_TRUE(measure_tracking(RecordedRun{.mission = run.mission}).distances.empty());
}

TEST(Tracking, LooksAtEachPlanOnItsOwnTime) {
  RecordedRun run = PlannedRun{}.make();
  // The same plan once more from 37 s on, as if planned anew where the swarm is at τ = 30 s: the
  // second one begins with what the first one had left, its wait.
  std::vector<PlanNode> nodes;
  std::vector<PlanLeg> legs;
  for (const PlanNode& node : run.plans[0].plan.nodes()) {
    if (node.time.count() < 30.0) continue;
    nodes.push_back(node);
    nodes.back().time -= MissionTime(30.0);
  }
  for (std::uint32_t k = 0; k < nodes.size(); ++k) {
    if (k % 3 > 0) legs.push_back({k - 1, k, 0.5});
  }
  auto rest = FlowPlan::make(nodes, legs);
  ASSERT_TRUE(rest.has_value()) << rest.error().message;
  run.plans.push_back({2, *rest});
  run.clock.push_back({run.begin + from_seconds(37.0), 2, 0.0, 1.0});
  for (Track& track : run.tracks) {
    for (TrackPoint& point : track.points) {
      if (point.time_s < 37.0) continue;
      point.plan_version = 2;
      point.plan_time_s -= 30.0F;
    }
  }

  const Tracking tracking = measure_tracking(run);

  ASSERT_EQ(tracking.plans.size(), 2U);
  for (const PlanDistance& plan : tracking.plans) {
    EXPECT_GT(plan.moments, 10U);
    EXPECT_LT(plan.mean.ratio(), 1.0) << plan.plan_version;
  }
  ASSERT_TRUE(tracking.w2_half && tracking.own.lag && tracking.references);
  EXPECT_NEAR(*tracking.centre_lag_s, 0.0, 0.1);
  EXPECT_NEAR(tracking.own.lag->amount_p99_s, 0.0, 0.05);
  EXPECT_LT(tracking.references->ratio(), 1.0);
}

TEST(Tracking, MeasuresTheLivingOnly) {
  PlannedRun flight;
  flight.falls = 4;

  const Tracking tracking = measure_tracking(flight.make());

  // One of 60 is missing from the sample's mass: one robot's place, up to 3 σ = 9 m off.
  ASSERT_TRUE(tracking.w2);
  EXPECT_LT(tracking.w2->ratio(), 1.2);
  EXPECT_NEAR(tracking.own.error->rms_m, 0.0, 0.02);
}

TEST(Tracking, TakesAFewOfManyRobots) {
  PlannedRun flight;
  flight.robots = 300;
  const RecordedRun run = flight.make();
  const auto moments = PlanTimeline(run).moments(2.0, 77.0, 5.0);

  const auto all = mean_distance(swarm_distances(run, moments));
  const auto few = mean_distance(swarm_distances(run, moments, 100));

  // Of every third robot the floor is that of a hundred: larger.
  ASSERT_TRUE(all && few);
  EXPECT_GT(few->floor_m, all->floor_m);
  EXPECT_NEAR(few->ratio(), all->ratio(), 0.3);
}

TEST(Tracking, IsShownInTheReport) {
  const AuditedRun audited = audit_recorded(PlannedRun{}.make());

  const std::string html = report_html(audited);

  for (const char* title : {"<h2>Distance to the plan</h2>", "<h2>Lag</h2>", "<h2>Density</h2>"}) {
    EXPECT_EQ(count_of(html, title), 1U) << title;
  }
  const std::size_t begin = html.find("<body>") + 6;
  EXPECT_EQ(xml_fault(html.substr(begin, html.find("<script>") - begin)), "");
}

}  // namespace
}  // namespace swarm::monitor
