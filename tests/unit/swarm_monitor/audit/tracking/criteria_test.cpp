// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/criteria.hpp"

#include <gtest/gtest.h>

namespace swarm::monitor {
namespace {

using Reasons = std::vector<std::string>;

/// Everything measured, of a swarm that is a little off.
Tracking measured() {
  Tracking tracking;
  tracking.clock = ClockUse{.covered_share = 1.0, .rate_mean = 1.0, .rate_min = 1.0};
  tracking.distances.resize(1);
  tracking.w2 = tracking.w2_half = tracking.references = Distance{.w2_m = 2.2, .floor_m = 2.0};
  tracking.centre_lag_s = -1.5;
  tracking.own.lag = LagQuantiles{.amount_p90_s = 2.5, .amount_p99_s = 8.0};
  tracking.own.error = ReferenceError{.p50_m = 0.5, .p95_m = 2.4, .rms_m = 1.5};
  tracking.own.followed_share = 1.0;
  tracking.own.clock_error_s = 0.1;
  tracking.density = DensityCourse{
      .worst_per_m2 = 1.8, .p95_per_m2 = 1.5, .planned_worst_per_m2 = 1.65, .cap_per_m2 = 1.5};
  tracking.risk = ExecutedRisk{.kept_share = 0.995};
  tracking.ending = {.to_goal = Distance{.w2_m = 3.3, .floor_m = 3.0},
                     .references_to_goal = Distance{.w2_m = 3.0, .floor_m = 3.0},
                     .own_place_share = 0.97};
  tracking.mission_over_plan_s = 11.0;
  tracking.arrival_spread_s = 30.0;
  return tracking;
}

CriteriaSpec all_set(double bar) {
  CriteriaSpec criteria;
  for (const auto& field : kCriteriaKeys) {
    criteria.*std::get<std::optional<double> CriteriaSpec::*>(field.member) = bar;
  }
  return criteria;
}

TEST(Criteria, JudgeNothingThatIsNotSet) {
  EXPECT_EQ(failed_criteria({}, measured(), 1.05), Reasons{});
  EXPECT_EQ(failed_criteria({}, Tracking{}, std::nullopt), Reasons{});
}

TEST(Criteria, NameTheValueAndTheBar) {
  const CriteriaSpec criteria{.w2_ratio_max = 1.05,
                              .centre_lag_max_s = 1.0,
                              .density_over_cap_max = 0.1,
                              .cvar_kept_share_min = 1.0};

  const Reasons reasons = failed_criteria(criteria, measured(), 1.05);

  EXPECT_EQ(reasons,
            (Reasons{"W2 of the swarm to the plan's mixture over its floor is 1.1; must be <= 1.05 "
                     "(w2_ratio_max)",
                     "earliness of the swarm's centre is 1.5 s; must be <= 1 (centre_lag_max_s)",
                     "flown peak density over the cap is 0.2; must be <= 0.1 "
                     "(density_over_cap_max)",
                     "share of the time with the CVaR kept in flight is 0.995; must be >= 1 "
                     "(cvar_kept_share_min)"}));
}

TEST(Criteria, AreEachJudgedByAQuantityOfTheirOwn) {
  // No bar of 100 is missed but those that ask for at least as much; of −1 all others are.
  const Reasons least{"cvar_kept_share_min", "own_place_share_min"};
  const Reasons high = failed_criteria(all_set(100.0), measured(), 1.05);
  const Reasons low = failed_criteria(all_set(-1.0), measured(), 1.05);

  ASSERT_EQ(high.size(), least.size());
  for (std::size_t i = 0; i < least.size(); ++i) {
    EXPECT_NE(high[i].find(least[i]), std::string::npos) << high[i];
  }
  EXPECT_EQ(low.size(), kCriteriaKeys.size() - least.size());
  for (const auto& field : kCriteriaKeys) {
    std::size_t named = 0;
    for (const Reasons& reasons : {high, low}) {
      for (const std::string& reason : reasons) {
        named += reason.ends_with("(" + std::string(field.key) + ")") ? 1 : 0;
      }
    }
    EXPECT_EQ(named, 1U) << field.key;
  }
}

TEST(Criteria, TakeNoEvidenceForAFailure) {
  const Reasons reasons = failed_criteria(all_set(0.5), Tracking{}, std::nullopt);

  EXPECT_EQ(reasons.size(), kCriteriaKeys.size());
  for (const std::string& reason : reasons) {
    EXPECT_NE(reason.find(": not measured: "), std::string::npos) << reason;
  }
}

TEST(Criteria, DoNotTakeReferencesThatAreNotThePlans) {
  Tracking tracking = measured();
  tracking.references->w2_m = 4.0;  // twice the floor
  const CriteriaSpec criteria{.w2_ratio_max = 2.0,
                              .lag_p90_max_s = 100.0,
                              .reference_p50_max_m = 100.0,
                              .own_place_share_min = 0.1};

  const Reasons reasons = failed_criteria(criteria, tracking, 1.05);

  EXPECT_EQ(reasons.size(), 3U);
  for (const std::string& reason : reasons) {
    EXPECT_NE(reason.find("the logged references are not those of the plan"), std::string::npos);
  }
}

TEST(Criteria, RejectPositionsThatAreNotTheGoals) {
  Tracking tracking = measured();
  tracking.ending.references_to_goal->w2_m = 6.0;

  EXPECT_EQ(failed_criteria({.own_place_share_min = 0.1}, tracking, 1.05),
            (Reasons{"own_place_share_min: not measured: the last references are not the goal's: "
                     "W2 6.00 m, floor 3.00"}));
}

TEST(Criteria, NeedACapToJudgeDensities) {
  Tracking tracking = measured();
  tracking.density->cap_per_m2.reset();

  EXPECT_EQ(failed_criteria({.density_over_cap_max = 0.3}, tracking, 1.05),
            (Reasons{"density_over_cap_max: not measured: the mission has no density cap"}));
}

}  // namespace
}  // namespace swarm::monitor
