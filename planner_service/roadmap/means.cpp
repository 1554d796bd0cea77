// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/means.hpp"

#include <cmath>

namespace swarm::planner {
namespace {

// Digits of `index` in `base`, mirrored at the point.
double radical_inverse(std::uint32_t index, std::uint32_t base) {
  double value = 0.0;
  double digit_value = 1.0 / base;
  for (; index > 0; index /= base, digit_value /= base) value += digit_value * (index % base);
  return value;
}

double fraction(double value) { return value - std::floor(value); }

Vec2 in_box(const Box& box, double u, double v) {
  return box.min_m + (box.max_m - box.min_m).cwiseProduct(Vec2(u, v));
}

}  // namespace

Vec2 uniform_mean(const Box& bounds_m, Rng& rng) {
  const double u = uniform01(rng);
  return in_box(bounds_m, u, uniform01(rng));
}

HaltonMeans::HaltonMeans(const Box& bounds_m, Rng& rng) : bounds_m_(bounds_m) {
  shift_.x() = uniform01(rng);
  shift_.y() = uniform01(rng);
}

// The sequence begins at index 1: index 0 would be the shift itself.
Vec2 HaltonMeans::next() {
  ++index_;
  return in_box(bounds_m_, fraction(radical_inverse(index_, 2) + shift_.x()),
                fraction(radical_inverse(index_, 3) + shift_.y()));
}

// All random numbers are drawn before any test, so that the draws do not depend on the world.
std::optional<Vec2> near_obstacle_mean(const World& world, double spread_m, double clearance_m,
                                       Rng& rng) {
  const Vec2 first = uniform_mean(world.bounds_m(), rng);
  const double dx = standard_normal(rng);
  const double dy = standard_normal(rng);
  const Vec2 second = first + spread_m * Vec2(dx, dy);
  const bool first_free = world.is_clear(first, clearance_m);
  const bool second_free = world.is_clear(second, clearance_m);
  if (first_free == second_free) return std::nullopt;
  if (first_free) return first;
  if (!world.bounds_m().contains(second)) return std::nullopt;
  return second;
}

}  // namespace swarm::planner
