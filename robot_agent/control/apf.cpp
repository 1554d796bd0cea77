// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/control/apf.hpp"

namespace swarm::agent {
namespace {

constexpr double kAtRest_m = 0.1;  // from the end point: stay

}  // namespace

void Apf::begin(const Route& route, const World& world) {
  sink_ = route.sink;
  pursuit_ = Pursuit(route.path, world, options_.part(&ApfOptions::pursuit));
  density_ = DensityAttraction(route.stations, options_.part(&ApfOptions::density));
  watch_ = GoalWatch(route.goal, pursuit_.end_m());
  escape_.forget();
}

bool Apf::has_arrived(const ControlView& view) {
  return watch_.has_arrived(view.now, view.position_m);
}

Vec2 Apf::repulsion(const ControlView& view) const {
  return neighbour_repulsion(view.position_m, view.close, options_->neighbour_repulsion) +
         obstacle_repulsion(view.position_m, view.world, options_->obstacle_repulsion);
}

Vec2 Apf::wish(const ControlView& view, bool arrived, Rng& rng) {
  const Pursuit::Aim aim = pursuit_.update(view.position_m, view.world);
  const auto escape = escape_.update(view, pursuit_.progress_m(), !arrived, rng);
  const Vec2 avoid = repulsion(view);
  if (escape) {
    const double left_m = (*escape - view.position_m).norm();
    return attraction(view.position_m, *escape, left_m, options_->attraction) + avoid;
  }
  if (arrived && aim.left_m < kAtRest_m) return avoid;
  Vec2 pull = attraction(view.position_m, aim.point_m, aim.left_m, options_->attraction);
  if (!arrived) pull += density_.pull(view.position_m, pursuit_.progress_m(), view.neighbours);
  return pull + avoid;
}

Vec2 Apf::hold(const ControlView& view) {
  escape_.forget();
  return repulsion(view);
}

}  // namespace swarm::agent
