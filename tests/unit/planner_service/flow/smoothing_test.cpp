// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "planner_service/flow/shortcuts.hpp"
#include "planner_service/flow/tighten.hpp"
#include "planner_service/roadmap/connect.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "tests/unit/planner_service/standin_scene.hpp"

namespace swarm::planner {
namespace {

Gaussian at(double x, double y) { return Gaussian::from_parameters({x, y}, 1.5, 1.5, 0.0); }

// A detour around a square block, with room to spare.
class Smoothing : public ::testing::Test {
 protected:
  World world_ = World::make({{0, 0}, {100, 100}},
                             {Polygon::make({{30, 0}, {70, 0}, {70, 40}, {30, 40}}).value()})
                     .value();
  RiskLimit risk_;
  EdgeChecker checker_{world_, risk_};
  Waypoints detour_{at(10, 10), at(12, 60), at(30, 80), at(55, 90),
                    at(75, 75), at(90, 60), at(90, 10)};

  void expect_free(const Waypoints& waypoints) {
    const double k = cvar_coefficient(risk_.alpha);
    for (std::size_t i = 1; i < waypoints.size(); ++i) {
      const Geodesic geodesic(waypoints[i - 1], waypoints[i]);
      for (int s = 0; s <= 200; ++s) {
        EXPECT_LE(max_cvar_m(geodesic.at(s / 200.0), world_, k), risk_.delta_m + kPlanTolerance_m);
      }
    }
  }

  void expect_same_ends(const Waypoints& waypoints) {
    ASSERT_GE(waypoints.size(), 2U);
    EXPECT_EQ(waypoints.front().mean_m(), detour_.front().mean_m());
    EXPECT_EQ(waypoints.back().mean_m(), detour_.back().mean_m());
    EXPECT_EQ(waypoints.back().covariance_m2(), detour_.back().covariance_m2());
  }
};

TEST_F(Smoothing, ShortcutsShortenAndStayFree) {
  Waypoints waypoints = detour_;
  Rng rng(1);

  take_shortcuts(waypoints, 100, checker_, rng);

  expect_same_ends(waypoints);
  expect_free(waypoints);
  EXPECT_LT(w2_length_m(waypoints), 0.95 * w2_length_m(detour_));
}

TEST_F(Smoothing, NoTriesChangeNothing) {
  Waypoints waypoints = detour_;
  Rng rng(1);

  take_shortcuts(waypoints, 0, checker_, rng);

  EXPECT_EQ(waypoints.size(), detour_.size());
  EXPECT_EQ(w2_length_m(waypoints), w2_length_m(detour_));
}

TEST_F(Smoothing, TighteningComesNearTheTautBand) {
  Waypoints waypoints = detour_;
  Rng rng(2);
  take_shortcuts(waypoints, 400, checker_, rng);
  const double before_m = w2_length_m(waypoints);

  tighten(waypoints, world_, risk_, {.sweeps = 200}, checker_);

  expect_same_ends(waypoints);
  expect_free(waypoints);
  EXPECT_LT(w2_length_m(waypoints), before_m);
  // The path of a point past both corners cannot be shorter.
  const Vec2 leg = Vec2(30, 40) - Vec2(10, 10);
  EXPECT_GT(w2_length_m(waypoints), 2.0 * leg.norm() + 40.0);
  // Without any change of shape the band is two tangents, two arcs at the clearance k·1.5 m − δ and
  // the roof; a band that may change shape is at most as long. Legs of 4 m cost less than 1 % on
  // arcs this tight.
  const double clearance_m = cvar_coefficient(risk_.alpha) * 1.5 - risk_.delta_m;
  const double tangent_m = std::sqrt(leg.squaredNorm() - clearance_m * clearance_m);
  const double turn_rad = std::atan2(leg.y(), leg.x()) + std::asin(clearance_m / leg.norm());
  EXPECT_LT(w2_length_m(waypoints), 1.01 * (2.0 * (tangent_m + clearance_m * turn_rad) + 40.0));
}

TEST_F(Smoothing, SuperfluousWaypointsGo) {
  Waypoints waypoints{at(10, 10), at(10, 20), at(10, 30), at(11, 60), at(10, 90)};

  drop_superfluous(waypoints, checker_);

  EXPECT_EQ(waypoints.size(), 2U);
}

TEST_F(Smoothing, CopesWithADirectRoute) {
  Waypoints waypoints{at(10, 10), at(10, 90)};
  Rng rng(3);

  take_shortcuts(waypoints, 50, checker_, rng);
  tighten(waypoints, world_, risk_, {}, checker_);
  drop_superfluous(waypoints, checker_);

  EXPECT_EQ(waypoints.size(), 2U);
}

}  // namespace
}  // namespace swarm::planner
