// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/gmm/shape_patches.hpp"

#include <cmath>
#include <string_view>

#include <gtest/gtest.h>

namespace swarm {
namespace {

struct Whole {
  double weight = 0.0;
  Vec2 mean_m = Vec2::Zero();
  Mat2 covariance_m2 = Mat2::Zero();
};

Whole together(const std::vector<Patch>& patches) {
  Whole whole;
  for (const Patch& p : patches) {
    whole.weight += p.weight;
    whole.mean_m += p.weight * p.center_m;
  }
  whole.mean_m /= whole.weight;
  for (const Patch& p : patches) {
    const Vec2 d = p.center_m - whole.mean_m;
    whole.covariance_m2 += p.weight / whole.weight * (p.spread_m2 + d * d.transpose());
  }
  return whole;
}

// The letter L: not convex.
Polygon letter_l(double scale, const Vec2& at) {
  std::vector<Vec2> vertices{{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 6}, {0, 6}};
  for (Vec2& v : vertices) v = at + scale * v;
  return Polygon::make(std::move(vertices)).value();
}

TEST(PolygonPatches, HaveThePolygonsAreaCentroidAndCovariance) {
  // By hand, as the rectangles [0,1]×[0,6] and [1,4]×[0,1]: areas 6 and 3, centroids (0.5, 3) and
  // (2.5, 0.5), variances (1/12, 36/12) and (9/12, 1/12), between them 6·3/81 ddᵀ, d = (2, −2.5).
  const Vec2 centroid(10.5 / 9.0, 19.5 / 9.0);
  Mat2 covariance;
  covariance << (6.0 / 12 + 27.0 / 12) / 9 + 2.0 / 9 * 4.0, -2.0 / 9 * 5.0, -2.0 / 9 * 5.0,
      (6.0 * 3 + 3.0 / 12) / 9 + 2.0 / 9 * 6.25;
  for (const std::size_t cells : {1U, 7U, 100U, 5000U}) {
    const Vec2 at(-500, 900);
    const auto patches = polygon_patches(letter_l(2.0, at), cells);
    const Whole whole = together(patches);

    EXPECT_NEAR(whole.weight, 4 * 9.0, 1e-9);
    EXPECT_LT((whole.mean_m - at - 2.0 * centroid).norm(), 1e-9);
    EXPECT_LT((whole.covariance_m2 - 4.0 * covariance).norm(), 1e-9);
  }
}

TEST(PolygonPatches, LieInTheirPolygonAndAreAboutAsManyAsAsked) {
  const Polygon polygon = letter_l(1.0, {0, 0});

  const auto patches = polygon_patches(polygon, 2400);

  // Cells of 0.1 m over the box of 4 × 6 m, of which 9 m² are the letter's.
  EXPECT_GE(patches.size(), 900U);
  EXPECT_LE(patches.size(), 1100U);
  for (const Patch& patch : patches) {
    EXPECT_TRUE(polygon.contains(patch.center_m)) << patch.center_m.transpose();
    EXPECT_LE(patch.weight, 0.01 + 1e-12);
  }
}

TEST(PolygonPatches, MissNoNeedle) {
  // A needle of 1 mm by 100 m, far thinner than a cell.
  const auto needle = Polygon::make({{0, 0}, {60, 80}, {59.9992, 80.0006}, {-0.0008, 0.0006}});

  const Whole whole = together(polygon_patches(needle.value(), 50));

  EXPECT_NEAR(whole.weight, 0.1, 1e-9);
  EXPECT_LT((whole.mean_m - Vec2(29.9996, 40.0003)).norm(), 1e-9);
}

GreyImage picture(std::size_t width, std::string_view dots) {
  GreyImage image{width, dots.size() / width, {}};
  for (const char c : dots) {
    image.levels.push_back(c == '#' ? 0 : c == '+' ? 153 : 255);
  }
  return image;
}

TEST(ImagePatches, AreItsDarkPixelsWithYUp) {
  const GreyImage image = picture(3,
                                  "#.."
                                  "..+");

  const auto patches = image_patches(image, {.origin_m = {10, 20}, .pixel_m = 2.0});

  ASSERT_EQ(patches.size(), 2U);
  EXPECT_EQ(patches[0].center_m, Vec2(11, 23));
  EXPECT_DOUBLE_EQ(patches[0].weight, 1.0);
  EXPECT_EQ(patches[1].center_m, Vec2(15, 21));
  EXPECT_DOUBLE_EQ(patches[1].weight, 0.4);  // (255 − 153)/255
  const Mat2 pixel_m2 = 4.0 / 12.0 * Mat2::Identity();
  EXPECT_LT((patches[0].spread_m2 - pixel_m2).norm(), 1e-15);
}

TEST(ImagePatches, MayBeTheBrightOnes) {
  const GreyImage image = picture(3,
                                  "###"
                                  "#.#");

  const auto patches = image_patches(image, {.dark = false});

  ASSERT_EQ(patches.size(), 1U);
  EXPECT_EQ(patches[0].center_m, Vec2(1.5, 0.5));
}

TEST(ImagePatches, AreTogetherTheSameImageInAnyBlocks) {
  GreyImage image{50, 31, {}};
  for (std::size_t i = 0; i < image.width * image.height; ++i) {
    image.levels.push_back(static_cast<std::uint8_t>((i * i + 37 * i) % 256));
  }
  const ImageFrame frame{.origin_m = {-3, 8}, .pixel_m = 0.5};
  const Whole all = together(image_patches(image, frame, 50 * 31));
  for (const std::size_t blocks : {1U, 4U, 100U, 700U}) {
    const auto patches = image_patches(image, frame, blocks);
    const Whole whole = together(patches);

    EXPECT_LE(patches.size(), blocks);
    EXPECT_NEAR(whole.weight, all.weight, 1e-9);
    EXPECT_LT((whole.mean_m - all.mean_m).norm(), 1e-9);
    EXPECT_LT((whole.covariance_m2 - all.covariance_m2).norm(), 1e-9);
  }
}

TEST(ImagePatches, AreNoneForABlankSheet) {
  EXPECT_TRUE(image_patches(picture(4, "........"), {}).empty());
}

// A mixture fitted to a shape has most of its mass in it, and no part of the shape is without.
TEST(ShapeFit, CoversThePolygonAndLittleElse) {
  const Polygon polygon = letter_l(5.0, {0, 0});  // strokes of 5 m
  const auto patches = polygon_patches(polygon);
  Rng rng(1);

  const auto fit = fit_mixture(patches, {.components = 12, .sigma_min_m = 0.5}, rng);

  ASSERT_TRUE(fit.has_value());
  int inside = 0;
  constexpr int kSamples = 20'000;
  for (int i = 0; i < kSamples; ++i) {
    const auto& g = fit->mixture.components()[fit->mixture.component_at(uniform01(rng))].gaussian;
    const double u = standard_normal(rng);
    const Vec2 z(u, standard_normal(rng));
    inside += polygon.contains(g.mean_m() + cholesky_lower(g.covariance_m2()) * z) ? 1 : 0;
  }
  // A row of Gaussians with a uniform strip's variance (5/√12 = 1.44 m) has erf(√1.5) = 92 % of its
  // mass within the strip; what leaks at the ends and corners comes on top.
  EXPECT_GT(inside, 0.8 * kSamples);
  const double uniform_density = 1.0 / (25.0 * 9.0);
  std::size_t covered = 0;
  for (const Patch& patch : patches) {
    covered += fit->mixture.density(patch.center_m) > 0.25 * uniform_density ? 1U : 0U;
  }
  EXPECT_GT(static_cast<double>(covered), 0.95 * static_cast<double>(patches.size()));
}

}  // namespace
}  // namespace swarm
