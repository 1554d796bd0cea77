// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/safety/safety_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace swarm::agent {
namespace {

constexpr int kBisections = 8;    // of the least violation: to 1 % of the speed
constexpr double kBlocked = 0.1;  // less than this share of the wish is left: blocked
constexpr std::array kTurns_rad{0.4, 0.9, 1.4};  // to the right, while blocked, until that is …
constexpr double kFree = 0.3;                    // … faster than this share of the wish
constexpr double kFollowMargin = 0.9;            // share of the margin that following may give up
constexpr double kEvade = 1.0 / 3.0;             // of the margin: kept to who does not keep off
constexpr double kFollows = 3.5;       // periods: who is known from before may have turned
constexpr double kFresh = 1.01;        // periods: known at once, but for rounding
constexpr double kWithdraw = 0.9;      // of the largest speed: out of an obstacle
constexpr double kStopped_m2ps = 1e-9;  // does not leave anybody
constexpr double kNever_m2 = 1e9;
constexpr double kLeastDesired_mps = 0.1;  // slower wishes are not worth a detour

}  // namespace

/// The lines of one call: all robots that a thread ticks in turn share the memory, and it stays in
/// the cache.
struct SafetyFilter::Lines {
  std::vector<HalfPlane> buffer;
  std::size_t obstacles = 0;  // the first ones
  std::size_t count = 0;
  std::vector<HalfPlane> relaxed;

  std::span<const HalfPlane> all() const { return std::span(buffer).first(count); }
  void make_room(std::size_t more) {
    if (buffer.size() < count + more) buffer.resize(2 * (count + more));
  }
};

SafetyFilter::SafetyFilter(const World& world, Shared<SafetyOptions> options)
    : world_(world), options_(std::move(options)), fresh_(pace(0.0)) {}

void SafetyFilter::collect_obstacles(const Vec2& position_m, Lines& lines) const {
  const double horizon_s = 2.0 * to_seconds(options_->period) + options_->lag_s;
  const double reach_m = options_->speed_max_mps * horizon_s + options_->obstacle_margin_m;
  const auto keep_off = [&](const Vec2& towards, double surface_gap_m, double coming_mps = 0.0) {
    if (surface_gap_m > reach_m + coming_mps * horizon_s) return;
    const double bound = (surface_gap_m - options_->obstacle_margin_m) / horizon_s - coming_mps;
    // One inside withdraws as fast as it can; to ask for more would freeze it.
    lines.make_room(1);
    lines.buffer[lines.count++] = {towards, std::max(bound, -kWithdraw * options_->speed_max_mps)};
  };
  const double searched_m = options_->radius_m + reach_m + world_.fastest_mps() * horizon_s;
  world_.convex_boxes().for_each_within({position_m, position_m}, searched_m, [&](std::uint32_t i) {
    const ConvexObstacle& obstacle = world_.convex_obstacles()[i];
    const SignedDistance sd = obstacle.signed_distance(position_m);
    keep_off(-sd.gradient, sd.distance_m - options_->radius_m,
             std::max(0.0, sd.gradient.dot(obstacle.velocity_mps)));
  });
  const Box& bounds = world_.bounds_m();
  keep_off({-1.0, 0.0}, position_m.x() - bounds.min_m.x() - options_->radius_m);
  keep_off({1.0, 0.0}, bounds.max_m.x() - position_m.x() - options_->radius_m);
  keep_off({0.0, -1.0}, position_m.y() - bounds.min_m.y() - options_->radius_m);
  keep_off({0.0, 1.0}, bounds.max_m.y() - position_m.y() - options_->radius_m);
  lines.obstacles = lines.count;
}

/// The time in which a neighbour's half of the gap may be closed, and what follows from it.
SafetyFilter::Pace SafetyFilter::pace(double information_age_s) const {
  const double period_s = to_seconds(options_->period);
  const double time_s = period_s + options_->gap_share * options_->lag_s +
                        options_->stale_gain * std::max(0.0, information_age_s - period_s);
  const double given_up_m = options_->speed_max_mps * std::max(information_age_s, period_s);
  return {
      .closing_hz = options_->gap_share / (2.0 * time_s),
      // If it stops at once …
      .follow = information_age_s > kFollows * period_s
                    ? 0.0
                    : std::min(options_->follow_share,
                               kFollowMargin * options_->neighbour_margin_m / given_up_m),
  };
}

void SafetyFilter::collect_neighbours(const Vec2& position_m, std::span<const Neighbour> neighbours,
                                      Lines& lines) const {
  const double period_s = to_seconds(options_->period);
  const double horizon_s = 2.0 * period_s + options_->lag_s;
  const double v_max = options_->speed_max_mps;
  const double margin_m = options_->neighbour_margin_m;
  const double evading_hz = 1.0 / horizon_s;
  const double possible_stop_reach_m = kEvade * margin_m + v_max * horizon_s;
  lines.make_room(2 * neighbours.size());
  HalfPlane* next = lines.buffer.data() + lines.count;
  for (const Neighbour& n : neighbours) {
    const Pace late = n.information_age_s > kFresh * period_s ? pace(n.information_age_s) : fresh_;
    const double sum_m = options_->radius_m + n.radius_m;
    const Vec2 offset = n.position_m - position_m;
    const double distance = offset.norm();
    // Robots believed to be in the same spot part to opposite sides by chance.
    const Vec2 towards = distance > 1e-9 ? Vec2(offset / distance) : Vec2(1.0, 0.0);
    const double gap = distance - sum_m;
    const double leaving = towards.dot(n.velocity_mps);
    // Who comes or leaves, and who bounds us, are coin tosses: no branches.
    const double away_mps = positive_part(leaving);
    const double coming_mps = away_mps - leaving;
    const double share = late.closing_hz * (gap - margin_m) + late.follow * away_mps;
    const double evade = evading_hz * (gap - kEvade * margin_m) - coming_mps;
    const double bound = std::min(share, evade);
    *next = {towards, std::max(bound, -v_max)};
    next += bound < v_max;
    const double left_behind_m = n.possible_stop_age_s * leaving;
    if (std::min(left_behind_m, possible_stop_reach_m + left_behind_m - gap) > 0.0) {
      if (const auto line = off_possible_stop(position_m, n, sum_m)) *next++ = *line;
    }
  }
  lines.count = static_cast<std::size_t>(next - lines.buffer.data());
}

/// Keeps off where the neighbour is if it stalled when that is worst for us: the nearest place of
/// its way since. One that stands does not come nearer, so neither must we: no more is asked.
std::optional<HalfPlane> SafetyFilter::off_possible_stop(const Vec2& position_m, const Neighbour& n,
                                                   double sum_m) const {
  const Vec2 back = -n.possible_stop_age_s * n.velocity_mps;
  const double share = (position_m - n.position_m).dot(back) / back.squaredNorm();
  const Vec2 offset = n.position_m + std::clamp(share, 0.0, 1.0) * back - position_m;
  const double distance = offset.norm();
  if (distance < 1e-9) return std::nullopt;  // we are where it would be: it went on
  const double bound = (distance - sum_m - kEvade * options_->neighbour_margin_m) /
                       (2.0 * to_seconds(options_->period) + options_->lag_s);
  if (bound >= options_->speed_max_mps) return std::nullopt;
  return HalfPlane{offset / distance, std::max(bound, 0.0)};
}

Listeners SafetyFilter::listeners(const Vec2& position_m, const Vec2& velocity_mps,
                                  std::span<const Neighbour> neighbours) const {
  const double horizon_s = 2.0 * to_seconds(options_->period) + options_->lag_s;
  const double kept_m = kEvade * options_->neighbour_margin_m;
  Listeners found;
  for (const Neighbour& n : neighbours) {
    const Vec2 offset = position_m - n.position_m;
    const double distance = offset.norm();
    const double gap_m = distance - options_->radius_m - n.radius_m;
    found.nearest_gap_m = std::min(found.nearest_gap_m, gap_m);
    const double leaving_m2ps = offset.dot(velocity_mps);
    // Who comes and whom it leaves are coin tosses: no branches.
    const double coming_m2ps = positive_part(offset.dot(n.velocity_mps));
    const double spare_m2 = positive_part((gap_m - kept_m) * distance - horizon_s * coming_m2ps);
    const double never_m2 = leaving_m2ps > 0.0 ? 0.0 : kNever_m2;
    found.timeout_s =
        std::min(found.timeout_s, (spare_m2 + never_m2) / std::max(leaving_m2ps, kStopped_m2ps));
  }
  found.timeout_s += horizon_s - options_->lag_s;
  return found;
}

/// All who are too near give in by the same speed, the least that leaves a common point. Nobody
/// comes nearer for it.
Vec2 SafetyFilter::least_violation(const Vec2& desired_mps, Lines& lines) const {
  const std::span<const HalfPlane> all = lines.all();
  lines.relaxed.assign(all.begin(), all.end());
  const auto relax = [&](double by_mps) {
    for (std::size_t i = lines.obstacles; i < all.size(); ++i) {
      const double bound = all[i].bound_mps;
      if (bound < 0.0) lines.relaxed[i].bound_mps = std::min(0.0, bound + by_mps);
    }
    return nearest_velocity(desired_mps, lines.relaxed, options_->speed_max_mps);
  };
  double low = 0.0;
  double high = 0.0;
  for (const HalfPlane& line : all.subspan(lines.obstacles)) high = std::max(high, -line.bound_mps);
  // Standing still breaks nothing by more than this, unless an obstacle comes.
  std::optional<Vec2> best = relax(high);
  if (!best) return Vec2::Zero();
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    if (auto u = relax(middle)) {
      best = u;
      high = middle;
    } else {
      low = middle;
    }
  }
  return *best;
}

Vec2 SafetyFilter::nearest(const Vec2& desired_mps, Lines& lines) const {
  if (auto u = nearest_velocity(desired_mps, lines.all(), options_->speed_max_mps)) return *u;
  return least_violation(desired_mps, lines);
}

Vec2 SafetyFilter::filter(const Vec2& position_m, const Vec2& desired_mps,
                          std::span<const Neighbour> neighbours, bool gives_way) const {
  static thread_local Lines lines;
  lines.count = 0;
  collect_obstacles(position_m, lines);
  collect_neighbours(position_m, neighbours, lines);
  const Vec2 u = nearest(desired_mps, lines);
  const double desired = desired_mps.norm();
  if (!gives_way || desired < kLeastDesired_mps) return u;
  if (u.dot(desired_mps) > kBlocked * desired * desired) return u;
  Vec2 turned = u;
  for (const double turn_rad : kTurns_rad) {
    const double c = std::cos(turn_rad);
    const double s = std::sin(turn_rad);
    turned =
        nearest({c * desired_mps.x() + s * desired_mps.y(), c * desired_mps.y() - s * desired_mps.x()}, lines);
    if (turned.norm() > kFree * desired) break;
  }
  return turned;
}

}  // namespace swarm::agent
