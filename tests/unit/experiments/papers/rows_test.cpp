// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/papers/rows.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::launcher {
namespace {

double path_m(const Flown& f) { return f.path_m; }

Row row_of(const std::vector<double>& paths_m) {
  Row row;
  for (const double path : paths_m) row.flown.push_back({.path_m = path});
  return row;
}

// A flight that a table accepts.
Flown good_flight() {
  return {.outcome = Outcome::kCompleted, .robots = 10, .arrived = 10, .contacts = 0};
}

TEST(Row, ItsStatisticsAreThoseOfTheSeeds) {
  Rng rng(1);
  for (int i = 0; i < 100; ++i) {
    std::vector<double> paths(1 + rng() % 9);
    for (double& path : paths) path = uniform(rng, 50.0, 60.0);
    const Row row = row_of(paths);
    // By other formulas: E[x²] − E[x]², and as many values above the median as below.
    double sum = 0.0;
    double squares = 0.0;
    for (const double path : paths) {
      sum += path;
      squares += path * path;
    }
    const auto n = static_cast<double>(paths.size());

    EXPECT_NEAR(row.mean(path_m), sum / n, 1e-12 * sum);
    EXPECT_NEAR(row.deviation(path_m), std::sqrt(std::max(0.0, squares / n - sum * sum / n / n)),
                1e-5);  // the difference of two large numbers
    EXPECT_EQ(row.least(path_m), *std::min_element(paths.begin(), paths.end()));
    const double median = row.median(path_m);
    const auto below =
        std::count_if(paths.begin(), paths.end(), [&](double p) { return p < median; });
    const auto above =
        std::count_if(paths.begin(), paths.end(), [&](double p) { return p > median; });
    EXPECT_EQ(below, above);
  }
}

TEST(Row, TheMedianOfAnEvenNumberIsTheMeanOfTheMiddle) {
  EXPECT_EQ(row_of({4, 1, 100, 2}).median(path_m), 3.0);
  EXPECT_EQ(row_of({4, 1, 100}).median(path_m), 4.0);
  EXPECT_EQ(row_of({7}).median(path_m), 7.0);
  EXPECT_EQ(row_of({7}).deviation(path_m), 0.0);
}

TEST(Row, IsGoodOnlyIfEveryFlightCompletedWithAllRobotsAndWithoutContact) {
  Row row;
  row.flown = {good_flight(), good_flight()};
  EXPECT_TRUE(row.good());
  const auto with = [&](auto change) {
    Row other = row;
    change(other.flown[1]);
    return other;
  };
  const Row late = with([](Flown& f) { f.outcome = Outcome::kTimeLimit; });
  const Row incomplete = with([](Flown& f) { f.arrived = 9; });
  const Row touching = with([](Flown& f) { f.contacts = 1; });

  EXPECT_FALSE(late.good());
  EXPECT_FALSE(incomplete.good());
  EXPECT_FALSE(touching.good());
  EXPECT_FALSE(late.all_completed());
  EXPECT_TRUE(incomplete.all_completed());
  for (Row ablation : {late, incomplete, touching}) {
    ablation.must_hold = false;
    EXPECT_TRUE(ablation.good()) << "an experiment that may fail never fails its table";
  }
}

TEST(Flown, RatiosAreThoseOfTheMeasurements) {
  EXPECT_EQ((Flown{.path_m = 12.0, .bound_m = 10.0}.ratio()), 1.2);
  EXPECT_EQ((Flown{.path_m = 12.0, .bound_m = 0.0}.ratio()), 0.0) << "robots that stay";
  EXPECT_EQ((Flown{.w2_m = 3.0, .w2_floor_m = 2.0}.w2_ratio()), 1.5);
  EXPECT_TRUE(std::isnan(Flown{}.w2_ratio())) << "not measured";
}

}  // namespace
}  // namespace swarm::launcher
