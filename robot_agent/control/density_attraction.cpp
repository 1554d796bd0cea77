// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/control/density_attraction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/LU>

#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::agent {
namespace {

constexpr double kRefresh_m = 1.0;  // of progress; Gaussians change little in between

}  // namespace

DensityAttraction::DensityAttraction(std::span<const Station> stations,
                                     Shared<DensityAttractionOptions> options)
    : options_(std::move(options)), stations_(stations.begin(), stations.end()) {}

void DensityAttraction::move_to(double progress_m) {
  while (leg_ + 2 < stations_.size() && stations_[leg_ + 1].at_m <= progress_m) ++leg_;
  const Station& from = stations_[leg_];
  const Station& to = stations_[std::min(leg_ + 1, stations_.size() - 1)];
  const double length_m = to.at_m - from.at_m;
  const double t = length_m > 0.0 ? std::clamp((progress_m - from.at_m) / length_m, 0.0, 1.0) : 0.0;
  planned_ = Geodesic(from.gaussian, to.gaussian).at(t);
  precision_ = planned_.covariance_m2().inverse();
  planned_robots_ = from.mass_out * options_->robots;
  planned_at_m_ = progress_m;
}

Vec2 DensityAttraction::pull(const Vec2& position_m, double progress_m,
                             std::span<const Neighbour> neighbours) {
  if (options_->push_mps <= 0.0 || stations_.empty()) return Vec2::Zero();
  if (planned_at_m_ < 0.0 || std::abs(progress_m - planned_at_m_) > kRefresh_m) move_to(progress_m);

  const double h2 = options_->kernel_m * options_->kernel_m;
  double density = 0.0;
  Vec2 gradient = Vec2::Zero();
  for (const Neighbour& n : neighbours) {
    const Vec2 offset = position_m - n.position_m;
    // Who is in reach is a coin toss: no branch.
    const double left = positive_part(1.0 - offset.squaredNorm() / h2);
    density += left * left;
    gradient -= 4.0 / h2 * left * offset;
  }
  const double scale = 3.0 / (std::numbers::pi * h2);
  const double planned = planned_robots_ * planned_.density(position_m);
  const Vec2 planned_gradient = -planned * (precision_ * (position_m - planned_.mean_m()));
  const double sum = scale * density + planned;
  if (sum < 1e-9) return Vec2::Zero();
  const Vec2 u =
      -options_->push_mps * options_->kernel_m / sum * (scale * gradient - planned_gradient);
  const double speed = u.norm();
  return speed > options_->push_mps ? Vec2(u * (options_->push_mps / speed)) : u;
}

}  // namespace swarm::agent
