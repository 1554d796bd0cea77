// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/methods/shared/virtual_diffusion.hpp"

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

const ShapeField kSquare = *ShapeField::make({}, {{{-1, -1}, {1, 1}}});

TEST(VirtualDiffusion, StaysInsideTheWorldHoweverStrong) {
  const World world = *World::make({{-2, -2}, {2, 2}}, {});
  Rng rng(1);

  for (int i = 0; i < 500; ++i) {
    const Vec2 end =
        virtual_diffusion({1.5, 1.5}, {.shape = nullptr, .neighbours = {}, .repulsion = {}}, world,
                          false, {.noise_mps05 = 50.0, .time_s = 10.0, .clearance_m = 0.1}, rng);
    EXPECT_LE(end.cwiseAbs().maxCoeff(), 1.9 + 1e-12);
  }
}

TEST(VirtualDiffusion, DoesNotJumpWalls) {
  const World world = *World::make({{-6, -6}, {6, 6}},
                                   {*Polygon::make({{1.0, -6}, {1.2, -6}, {1.2, 6}, {1.0, 6}})});
  Rng rng(2);

  for (int i = 0; i < 500; ++i) {
    const Vec2 end =
        virtual_diffusion({-1, 0}, {.shape = nullptr, .neighbours = {}, .repulsion = {}}, world,
                          false, {.noise_mps05 = 3.0, .time_s = 5.0, .clearance_m = 0.1}, rng);
    EXPECT_LE(end.x(), 0.9 + 1e-9);
  }
}

TEST(VirtualDiffusion, EndsInSightWhereAsked) {
  const World world =
      *World::make({{-6, -6}, {6, 6}}, {*Polygon::make({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})});
  Rng rng(3);
  int hidden = 0;

  for (int i = 0; i < 500; ++i) {
    const DiffusionOptions options{.noise_mps05 = 4.0, .time_s = 10.0, .clearance_m = 0.1};
    const Vec2 seen = virtual_diffusion(
        {-2, 0}, {.shape = nullptr, .neighbours = {}, .repulsion = {}}, world, true, options, rng);
    const Vec2 any = virtual_diffusion(
        {-2, 0}, {.shape = nullptr, .neighbours = {}, .repulsion = {}}, world, false, options, rng);
    EXPECT_TRUE(world.segment_is_free({-2, 0}, seen, 0.1));
    hidden += world.segment_is_free({-2, 0}, any, 0.1) ? 0 : 1;
  }

  EXPECT_GT(hidden, 50);
}

TEST(VirtualDiffusion, ComesBackToTheShapeAndSpreadsOverIt) {
  const World world = *World::make({{-6, -6}, {6, 6}}, {});
  Rng rng(4);
  Vec2 sum = Vec2::Zero();
  double squares = 0.0;
  constexpr int kRuns = 2000;

  for (int i = 0; i < kRuns; ++i) {
    const Vec2 end =
        virtual_diffusion({-1, -1}, {.shape = &kSquare, .neighbours = {}, .repulsion = {}}, world,
                          false, {.noise_mps05 = 3.0, .time_s = 10.0}, rng);
    sum += end;
    squares += end.squaredNorm();
    EXPECT_LT(kSquare.at(end).energy_m2, 36.0);
  }

  EXPECT_LT((sum / kRuns).norm(), 0.5);  // has left its corner
  EXPECT_GT(squares / kRuns, 0.5);
  EXPECT_LT(squares / kRuns, 4.0);
}

}  // namespace
}  // namespace swarm::agent
