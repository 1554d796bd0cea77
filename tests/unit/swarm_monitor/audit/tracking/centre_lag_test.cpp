// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/centre_lag.hpp"

#include <gtest/gtest.h>

#include "tests/unit/swarm_monitor/audit/tracking/planned_run.hpp"

namespace swarm::monitor {
namespace {

std::optional<double> lag_of(const PlannedRun& flight) {
  const RecordedRun run = flight.make();
  const auto moments = PlanTimeline(run).moments(0.0, flight.end_s, 1.0);
  return centre_lag_s(run, moments);
}

TEST(CentreLag, IsTheShiftOfTheWholeSwarm) {
  for (const double shift_s : {-12.0, -3.0, 0.0, 0.5, 7.0}) {
    PlannedRun flight;
    flight.position_m = [&](std::uint32_t i, double tau) {
      return flight.reference_m(i, std::max(0.0, tau - shift_s));
    };

    const auto lag = lag_of(flight);

    ASSERT_TRUE(lag);
    // One step of the search, and the swarm's own centre: its seeds lie 0.12 m ahead, 0.1 s.
    EXPECT_NEAR(*lag, shift_s, 0.16) << shift_s;
  }
}

TEST(CentreLag, OfASwarmThatStaysIsTheMostThatIsLookedFor) {
  PlannedRun flight;
  flight.position_m = [&](std::uint32_t i, double) { return flight.reference_m(i, 0.0); };

  EXPECT_NEAR(*lag_of(flight), kMostCentreLag_s, 1e-9);
}

TEST(CentreLag, NeedsAMoment) { EXPECT_FALSE(centre_lag_s(PlannedRun{}.make(), {})); }

TEST(CentreLag, MeanOfAPlanIsThatOfItsMixture) {
  const FlowPlan plan = PlannedRun{}.plan();
  for (const double tau : {-1.0, 0.0, 12.5, 35.0, 69.9, 70.0, 90.0}) {
    Vec2 mean = Vec2::Zero();
    const Mixture mixture = plan.mixture_at(MissionTime(tau));
    for (const auto& [weight, gaussian] : mixture.components()) {
      mean += weight * gaussian.mean_m();
    }

    EXPECT_NEAR((plan_mean(plan, tau) - mean).norm(), 0.0, 1e-9) << tau;
  }
}

}  // namespace
}  // namespace swarm::monitor
