// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/methods/apf/apf.hpp"

namespace swarm::agent {
namespace {

constexpr double kAtRest_m = 0.1;  // arrived robots this near to their end point rest
constexpr double kBehind_m = 1.0;  // a robot less behind its reference does not count as stuck

}  // namespace

/// A new plan keeps the arrival watch if the end point is the same, so that arrived robots stay so.
void Apf::begin(const Route& route, const World& world) {
  sink_ = route.sink;
  pursuit_ = Pursuit(route.path, world, options_.part(&ApfOptions::pursuit));
  pace_ = Pace(route.schedule, route.path.length_m());
  if (!watch_.is_for(route.goal, pursuit_.end_m())) {
    watch_ = GoalWatch(route.goal, pursuit_.end_m(), options_->scale);
  }
  in_time_.reset();
  escape_.forget();
}

[[gnu::hot]] bool Apf::has_arrived(const ControlView& view) {
  return watch_.has_arrived(view.now, view.position_m);
}

/// The repulsive part w₂U_rep of eq. 14, of neighbours and of the nearest obstacle.
[[gnu::hot]] Vec2 Apf::repulsion(const ControlView& view) const {
  return neighbour_repulsion(view.position_m, view.close, options_->neighbour_repulsion) +
         obstacle_repulsion(view.position_m, view.world, options_->obstacle_repulsion);
}

/// Only while under way: an arrived robot keeps its slot, whatever the density.
Vec2 Apf::attraction_to_density(const ControlView& view, bool arrived) const {
  if (arrived || view.planned_density == nullptr) return Vec2::Zero();
  return density_attraction(view.position_m, *view.planned_density, view.neighbours,
                            options_->density);
}

/// Attraction to an intermediate target of an escape, slower in proportion to the distance left.
Vec2 Apf::attraction_to(const Vec2& escape_m, const ControlView& view) const {
  const PaceOptions& pace = options_->pace;
  return attraction(view.position_m, escape_m,
                    free_speed(0.0, pace.approach_gain_hz, pace.cruise_mps));
}

/// Attraction that keeps the plan's time: aims at most at the carrot c = l*(τ + τ̇T), at the speed
/// that pace.hpp gives. Its arc length s is c less the distance still to drive to the carrot.
[[gnu::hot]] Vec2 Apf::attraction_in_time(const ControlView& view, bool arrived, Rng& rng) {
  const PaceOptions& pace = options_->pace;
  const Pace::Now now = pace_.at(*view.plan_time, pace);
  const Pursuit::Aim aim = pursuit_.update(view.position_m, view.world, now.carrot_m);
  const double ahead_m = (aim.point_m - view.position_m).norm() + aim.rest_m;
  const double at_m = now.carrot_m - (aim.past_m > 0.0 ? -aim.past_m : ahead_m);
  in_time_ = InTime{*view.plan_time, now.reference_m, at_m};
  const bool is_behind = now.reference_m - at_m > options_->scale * kBehind_m;
  const auto escape = escape_.update(view, pursuit_.progress_m(), !arrived && is_behind, rng);
  if (escape) return attraction_to(*escape, view);
  if (arrived && aim.left_m < options_->scale * kAtRest_m) return Vec2::Zero();
  // Ahead of the carrot: far ahead it returns slowly, otherwise it waits for the carrot.
  if (aim.past_m > options_->scale * Pace::kPast_m) {
    return attraction(
        view.position_m, aim.point_m,
        free_speed(aim.rest_m, pace.approach_gain_hz, options_->scale * Pace::kReturn_mps));
  }
  if (aim.past_m > 0.0) return Vec2::Zero();
  return attraction(view.position_m, aim.point_m, Pace::speed(now, aim.rest_m, pace)) +
         attraction_to_density(view, arrived);
}

/// Without a clock (tracking: free, or no heartbeat yet): along the path at cruise speed. Any lack
/// of progress counts as stuck.
Vec2 Apf::attraction_at_will(const ControlView& view, bool arrived, Rng& rng) {
  const PaceOptions& pace = options_->pace;
  const Pursuit::Aim aim = pursuit_.update(view.position_m, view.world);
  const auto escape = escape_.update(view, pursuit_.progress_m(), !arrived, rng);
  if (escape) return attraction_to(*escape, view);
  if (arrived && aim.left_m < options_->scale * kAtRest_m) return Vec2::Zero();
  return attraction(view.position_m, aim.point_m,
                    free_speed(aim.rest_m, pace.approach_gain_hz, pace.cruise_mps)) +
         attraction_to_density(view, arrived);
}

[[gnu::hot]] Vec2 Apf::desired_velocity(const ControlView& view, bool arrived, Rng& rng) {
  const bool keeps_time = options_->keeps_time && view.plan_time;
  return (keeps_time ? attraction_in_time(view, arrived, rng)
                     : attraction_at_will(view, arrived, rng)) +
         repulsion(view);
}

/// No attraction, so held robots only give way to those that press. Time held is no time stuck.
Vec2 Apf::hold(const ControlView& view) {
  escape_.forget();
  return repulsion(view);
}

[[gnu::hot]] std::optional<TimeTracking> Apf::tracking() const {
  if (!in_time_) return std::nullopt;
  return TimeTracking{.plan_time_s = in_time_->time.plan_time_s,
                      .reference_m = pursuit_.point_m(in_time_->reference_m)};
}

double Apf::lag_s() const { return in_time_ ? pace_.lag_s(in_time_->time, in_time_->at_m) : 0.0; }

}  // namespace swarm::agent
