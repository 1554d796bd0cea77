// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A swarm that does what was published passes; each single fault turns the verdict, and the reason
// names it.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "planned_run.hpp"
#include "swarm_monitor/audit/audit.hpp"

namespace swarm::monitor {
namespace {

Audit audit_of(const PlannedRun& flight) { return audit_recorded(flight.make()).audit; }

std::string all(const Audit& audit) { return fmt::format("{}", fmt::join(audit.reasons, "\n")); }

bool names(const Audit& audit, std::string_view fragment) {
  return std::any_of(audit.reasons.begin(), audit.reasons.end(), [&](const std::string& reason) {
    return reason.find(fragment) != std::string::npos;
  });
}

TEST(Mutation, ASwarmThatFliesThePlanPasses) {
  const Audit audit = audit_of({});

  EXPECT_TRUE(audit.ok()) << all(audit);
  const Tracking& tracking = audit.tracking;
  ASSERT_TRUE(tracking.w2 && tracking.own.lag && tracking.own.error && tracking.density);
  EXPECT_LT(tracking.w2->ratio(), 1.0) << "more even than a sample";
  EXPECT_NEAR(*tracking.centre_lag_s, 0.0, 0.1);
  EXPECT_NEAR(tracking.own.lag->amount_p99_s, 0.0, 0.05);
  EXPECT_NEAR(tracking.own.error->p95_m, 0.0, 0.02);
  EXPECT_LT(*tracking.own.clock_error_s, 1e-4);
  EXPECT_EQ(tracking.own.followed_share, 1.0);
  EXPECT_EQ(tracking.risk->kept_share, 1.0);
  EXPECT_NEAR(tracking.clock->rate_min, 0.5, 1e-12);
}

TEST(Mutation, AWrongGoal) {
  PlannedRun flight;
  // Still within the 99 % ellipse of the goal that each robot names.
  flight.position_m = [&](std::uint32_t i, double tau) -> Vec2 {
    return flight.reference_m(i, tau) + Vec2(0.0, i % 2 == 0 ? -1.0 : 1.0) * (tau / 70.0);
  };

  const Audit audit = audit_of(flight);

  EXPECT_TRUE(names(audit, "own_place_share_min")) << all(audit);
  EXPECT_EQ(audit.arrived, audit.robots) << "by the goals that robots name, all is well";
}

TEST(Mutation, AGoalThatRobotsMadeUp) {
  PlannedRun flight;
  const auto elsewhere = [&](std::uint32_t i, double tau) -> Vec2 {
    return flight.reference_m(i, tau) + Vec2(0.0, i % 2 == 0 ? -5.0 : 5.0) * (tau / 70.0);
  };
  flight.position_m = elsewhere;
  flight.logged_reference_m = elsewhere;

  const Audit audit = audit_of(flight);

  EXPECT_TRUE(names(audit, "w2_end_ratio_max")) << all(audit);
  EXPECT_TRUE(names(audit, "w2_ratio_max")) << all(audit);
}

TEST(Mutation, ASwarmThatIgnoresItsPlan) {
  PlannedRun flight;
  flight.logs_references = false;
  // At its own speed, without the wait.
  flight.position_m = [&](std::uint32_t i, double tau) -> Vec2 {
    const double x_m = std::min(15.0 + 1.45 * tau, 90.0);
    return Vec2(x_m - 15.0, 0.0) + flight.reference_m(i, 0.0);
  };

  const Audit audit = audit_of(flight);

  for (const char* key : {"w2_ratio_max", "centre_lag_max_s", "lag_p90_max_s: not measured",
                          "reference_p50_max_m: not measured", "own_place_share_min"}) {
    EXPECT_TRUE(names(audit, key)) << key << " in\n" << all(audit);
  }
}

TEST(Mutation, TwentyPerCentEarly) {
  PlannedRun flight;
  flight.position_m = [&](std::uint32_t i, double tau) { return flight.reference_m(i, tau / 0.8); };

  const Audit audit = audit_of(flight);

  for (const char* key : {"w2_ratio_max", "earliness of the swarm's centre", "lag_p90_max_s",
                          "reference_rms_max_m"}) {
    EXPECT_TRUE(names(audit, key)) << key << " in\n" << all(audit);
  }
  EXPECT_LT(*audit.tracking.centre_lag_s, -3.0);
  EXPECT_LT(audit.tracking.own.lag->p10_s, -3.0);
}

TEST(Mutation, TwentyPerCentLate) {
  PlannedRun flight;
  flight.end_s = 120.0;
  flight.position_m = [&](std::uint32_t i, double tau) { return flight.reference_m(i, tau / 1.2); };

  const Audit audit = audit_of(flight);

  for (const char* key : {"w2_ratio_max", "lag of the swarm's centre", "lag_p90_max_s",
                          "reference_rms_max_m", "mission_over_plan_max_s"}) {
    EXPECT_TRUE(names(audit, key)) << key << " in\n" << all(audit);
  }
  EXPECT_GT(*audit.tracking.centre_lag_s, 3.0);
  EXPECT_GT(audit.tracking.own.lag->p90_s, 3.0);
}

TEST(Mutation, TwentyPerCentLateByAClockOfItsOwn) {
  PlannedRun flight;
  flight.end_s = 120.0;
  flight.position_m = [&](std::uint32_t i, double tau) { return flight.reference_m(i, tau / 1.2); };
  flight.logged_plan_time_s = [](double tau) { return tau / 1.2; };

  const Audit audit = audit_of(flight);

  EXPECT_TRUE(names(audit, "clock_error_max_s")) << all(audit);
  EXPECT_TRUE(names(audit, "w2_ratio_max")) << all(audit);
}

TEST(Mutation, ReferencesThatAreNotThePlans) {
  PlannedRun flight;
  // Twenty seconds late, and the log has this as the planned position.
  flight.position_m = [&](std::uint32_t i, double tau) {
    return flight.reference_m(i, std::max(0.0, tau - 20.0));
  };
  flight.logged_reference_m = flight.position_m;

  const Audit audit = audit_of(flight);

  EXPECT_TRUE(names(audit, "lag_p90_max_s: not measured: the logged references are not"))
      << all(audit);
}

TEST(Mutation, ARobotThroughAFallenOne) {
  PlannedRun flight;
  flight.falls = 0;  // in the middle of its stream, behind others' references
  const Audit audit = audit_of(flight);
  EXPECT_GT(audit.collisions_fallen, 0U);
  EXPECT_EQ(audit.collisions_robot, 0U);
  EXPECT_TRUE(names(audit, "touched after one had died: 0-")) << all(audit);

  // The same without anybody behind it.
  PlannedRun alone = flight;
  alone.falls = 1;
  alone.position_m = [&](std::uint32_t i, double tau) -> Vec2 {
    return flight.reference_m(i, tau) + (i == 1 ? Vec2(0.0, -15.0) : Vec2(0.0, 0.0));
  };
  EXPECT_EQ(audit_of(alone).collisions_fallen, 0U);
}

TEST(Mutation, ARobotOutsideTheBounds) {
  PlannedRun flight;
  std::uint32_t highest = 0;  // no robot is above it
  for (std::uint32_t i = 1; i < flight.robots; ++i) {
    if (flight.reference_m(i, 0.0).y() > flight.reference_m(highest, 0.0).y()) highest = i;
  }
  flight.position_m = [&](std::uint32_t i, double tau) -> Vec2 {
    const bool strays = i == highest && tau > 20.0 && tau < 21.0;
    return flight.reference_m(i, tau) + (strays ? Vec2(0.0, 25.0) : Vec2(0.0, 0.0));
  };

  const Audit audit = audit_of(flight);

  EXPECT_EQ(all(audit), fmt::format("1 left the world's bounds: robot {}", highest));
}

TEST(Mutation, APlanTwiceAsDenseAsItsCap) {
  PlannedRun flight;
  flight.sigma_m = 1.97;  // 1 − exp(−R²/2σ²) of a stream lies in a disc: twice that of 3 m

  const Audit audit = audit_of(flight);

  for (const char* key :
       {"planned_over_cap_max", "density_over_cap_p95_max", "density_over_cap_max"}) {
    EXPECT_TRUE(names(audit, key)) << key << " in\n" << all(audit);
  }
}

TEST(Mutation, NoPublishedClock) {
  RecordedRun run = PlannedRun{}.make();
  run.clock.clear();

  const Audit audit = audit_recorded(std::move(run)).audit;

  EXPECT_TRUE(names(audit, "w2_ratio_max: not measured: no plan clock was published"))
      << all(audit);
}

TEST(Mutation, AClockThatStopsBeingPublishedIsNoEvidence) {
  RecordedRun run = PlannedRun{}.make();
  run.clock.push_back(
      {run.begin + from_seconds(40.0), 2, 0.0, 1.0});  // a plan that was not recorded

  const Audit audit = audit_recorded(std::move(run)).audit;

  EXPECT_TRUE(names(audit, "w2_ratio_max: not measured: the published clock names a recorded plan"))
      << all(audit);
}

}  // namespace
}  // namespace swarm::monitor
