// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/mixture.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace swarm {
namespace {

Gaussian at(double x) { return Gaussian::from_parameters({x, 0}, 1.0, 1.0, 0.0); }

TEST(Mixture, RefusesWeightsThatAreNoDistribution) {
  const double nan = std::numeric_limits<double>::quiet_NaN();

  EXPECT_FALSE(Mixture::make({}).has_value());
  EXPECT_FALSE(Mixture::make({{0.5, at(0)}, {0.4, at(1)}}).has_value());
  EXPECT_FALSE(Mixture::make({{1.0, at(0)}, {0.0, at(1)}}).has_value());
  EXPECT_FALSE(Mixture::make({{1.5, at(0)}, {-0.5, at(1)}}).has_value());
  EXPECT_FALSE(Mixture::make({{nan, at(0)}}).has_value());
}

TEST(Mixture, NormalisesWhatRoundingLeft) {
  const auto mixture = Mixture::make({{0.5 + 4e-7, at(0)}, {0.5, at(1)}});

  ASSERT_TRUE(mixture.has_value());
  const double sum = mixture->components()[0].weight + mixture->components()[1].weight;
  EXPECT_DOUBLE_EQ(sum, 1.0);
}

TEST(Mixture, DensityIsTheWeightedSum) {
  const auto mixture = Mixture::make({{0.25, at(0)}, {0.75, at(3)}});

  ASSERT_TRUE(mixture.has_value());
  const Vec2 p(1, 0.5);
  EXPECT_DOUBLE_EQ(mixture->density(p), 0.25 * at(0).density(p) + 0.75 * at(3).density(p));
}

TEST(Mixture, SharesFallToComponentsByTheirWeights) {
  const auto mixture = Mixture::make({{0.25, at(0)}, {0.5, at(1)}, {0.25, at(2)}});

  ASSERT_TRUE(mixture.has_value());
  EXPECT_EQ(mixture->component_at(0.0), 0U);
  EXPECT_EQ(mixture->component_at(0.2499), 0U);
  EXPECT_EQ(mixture->component_at(0.25), 1U);
  EXPECT_EQ(mixture->component_at(0.7499), 1U);
  EXPECT_EQ(mixture->component_at(0.75), 2U);
  EXPECT_EQ(mixture->component_at(0.999999999), 2U);
}

}  // namespace
}  // namespace swarm
