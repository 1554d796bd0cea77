// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/safety/safety_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numbers>
#include <vector>

namespace swarm::agent {
namespace {

constexpr int kBisections = 8;    // of the least violation: to 1 % of the speed
constexpr double kBlocked = 0.1;  // less than this share of the desired speed is left: blocked
constexpr std::array kTurns_rad{0.4, 0.9, 1.4};  // to the right, tried in this order while blocked
constexpr double kFree = 0.3;  // a turn is taken if it leaves this share of the desired speed
constexpr double kFollowMargin = 0.9;   // share of the margin that following may use up
constexpr double kEvade = 1.0 / 3.0;    // share of the margin kept to any other robot
constexpr double kFollows = 3.5;        // periods: a robot whose state is older may have turned
constexpr double kFresh = 1.01;         // periods: up to this age states are fresh (rounding)
constexpr double kWithdraw = 0.9;       // share of the largest speed, out of an obstacle
constexpr double kStopped_m2ps = 1e-9;  // slower does not move away from a neighbour
constexpr double kNever_m2 = 1e9;
constexpr double kLeastDesired_mps = 0.1;  // slower desired velocities are not worth a turn

}  // namespace

/// The half-planes of one call. All robots that a thread ticks in turn share the buffers, which
/// stay in the cache.
struct SafetyFilter::Lines {
  std::vector<HalfPlane> buffer;
  std::size_t obstacles = 0;  // the first of them belong to obstacles and bounds
  std::size_t bodies = 0;     // the first of them, but for those of the discs of silent robots
  std::size_t count = 0;
  std::vector<HalfPlane> relaxed;
  std::vector<Neighbour> sorted;

  std::span<const HalfPlane> all() const { return std::span(buffer).first(count); }
  void make_room(std::size_t more) {
    if (buffer.size() < count + more) buffer.resize(2 * (count + more));
  }
};

SafetyFilter::Lines& SafetyFilter::empty_lines() {
  static thread_local Lines lines;
  lines.count = 0;
  return lines;
}

SafetyFilter::SafetyFilter(const World& world, Shared<SafetyOptions> options)
    : world_(world), options_(std::move(options)), fresh_(pace(0.0)) {}

/// A half-plane for each convex part in reach and for the four bounds of the world: the surface gap
/// above the margin may be closed within the 2Δt that a command lasts, plus the lag. A robot inside
/// the margin withdraws; if it `stands`, only from obstacles that approach.
[[gnu::hot]] void SafetyFilter::collect_obstacles(const Vec2& position_m, Lines& lines,
                                                  bool stands) const {
  const double horizon_s = 2.0 * to_seconds(options_->period) + options_->lag_s;
  // Farther surfaces cannot bound the velocity: their bound would be above v_max.
  const double reach_m = options_->speed_max_mps * horizon_s + options_->obstacle_margin_m;
  const auto keep_off = [&](const Vec2& towards, double surface_gap_m, double coming_mps = 0.0) {
    if (surface_gap_m > reach_m + coming_mps * horizon_s) return;
    const double bound = (surface_gap_m - options_->obstacle_margin_m) / horizon_s - coming_mps;
    // A robot inside the margin withdraws at 0.9 v_max: a half-plane that asks for more might not
    // meet the disc ‖u‖ ≤ v_max, and without a solution the robot would stop.
    const double withdraws_mps =
        stands && coming_mps <= 0.0 ? 0.0 : kWithdraw * options_->speed_max_mps;
    lines.make_room(1);
    lines.buffer[lines.count++] = {towards, std::max(bound, -withdraws_mps)};
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

/// Closing rate γ/(2T) and follow share β towards a neighbour whose information is this old, with
/// T = Δt + γλ + a max(0, τ − Δt).
SafetyFilter::Pace SafetyFilter::pace(double information_age_s) const {
  const double period_s = to_seconds(options_->period);
  const double time_s = period_s + options_->gap_share * options_->lag_s +
                        options_->stale_gain * std::max(0.0, information_age_s - period_s);
  const double given_up_m = options_->speed_max_mps * std::max(information_age_s, period_s);
  return {
      .closing_hz = options_->gap_share / (2.0 * time_s),
      // Following a robot that stops at once uses up β v_max τ: at most 0.9 of the margin.
      .follow = information_age_s > kFollows * period_s
                    ? 0.0
                    : std::min(options_->follow_share,
                               kFollowMargin * options_->neighbour_margin_m / given_up_m),
  };
}

/// The half-planes of the neighbours: first and second line as one, the tighter bound of the two,
/// and the third where the neighbour moves away and may have stopped within reach. Discs of silent
/// robots come last. O(neighbours).
[[gnu::hot]] void SafetyFilter::collect_neighbours(const Vec2& position_m,
                                                   std::span<const Neighbour> neighbours,
                                                   Lines& lines) const {
  const double period_s = to_seconds(options_->period);
  const double horizon_s = 2.0 * period_s + options_->lag_s;
  const double v_max = options_->speed_max_mps;
  const double margin_m = options_->neighbour_margin_m;
  const double evading_hz = 1.0 / horizon_s;
  const double possible_stop_reach_m = kEvade * margin_m + v_max * horizon_s;
  lines.make_room(2 * neighbours.size());
  HalfPlane* next = lines.buffer.data() + lines.count;
  const HalfPlane* first_disc = nullptr;
  for (const Neighbour& n : neighbours) {
    if (n.is_silent && first_disc == nullptr) first_disc = next;
    const Pace late = n.information_age_s > kFresh * period_s ? pace(n.information_age_s) : fresh_;
    const double sum_m = options_->radius_m + n.radius_m;
    const Vec2 offset = n.position_m - position_m;
    const double distance = offset.norm();
    // Two robots estimated at the same position: any direction will do.
    const Vec2 towards = distance > 1e-9 ? Vec2(offset / distance) : Vec2(1.0, 0.0);
    const double gap = distance - sum_m;
    const double leaving = towards.dot(n.velocity_mps);
    // Which neighbours approach and which bound us is unpredictable: no branches.
    const double away_mps = positive_part(leaving);
    const double coming_mps = away_mps - leaving;
    const double share = late.closing_hz * (gap - margin_m) + late.follow * away_mps;
    const double evade = evading_hz * (gap - kEvade * margin_m) - coming_mps;
    const double bound = std::min(share, evade);
    // Always written, kept only if it bounds us.
    *next = {towards, std::max(bound, -v_max)};
    next += bound < v_max;
    // How much nearer the neighbour is if it stopped as early as it may have.
    const double left_behind_m = n.possible_stop_age_s * leaving;
    if (std::min(left_behind_m, possible_stop_reach_m + left_behind_m - gap) > 0.0) {
      if (const auto line = off_possible_stop(position_m, n, sum_m)) *next++ = *line;
    }
  }
  lines.count = static_cast<std::size_t>(next - lines.buffer.data());
  lines.bodies = first_disc == nullptr ? lines.count
                                       : static_cast<std::size_t>(first_disc - lines.buffer.data());
}

/// The second lines, for a robot that stands. Only that of a neighbour that approaches asks for a
/// retreat: one that keeps off by itself does not come near enough for it. A neighbour that is only
/// extrapolated does not count as approaching: it may have turned since.
void SafetyFilter::collect_approaching(const Vec2& position_m,
                                       std::span<const Neighbour> neighbours, Lines& lines) const {
  const double horizon_s = 2.0 * to_seconds(options_->period) + options_->lag_s;
  const double v_max = options_->speed_max_mps;
  lines.make_room(neighbours.size());
  for (const Neighbour& n : neighbours) {
    const Vec2 offset = n.position_m - position_m;
    const double distance = offset.norm();
    const Vec2 towards = distance > 1e-9 ? Vec2(offset / distance) : Vec2(1.0, 0.0);
    const double gap = distance - options_->radius_m - n.radius_m;
    const double coming_mps =
        n.possible_stop_age_s > 0.0 ? 0.0 : positive_part(-towards.dot(n.velocity_mps));
    const double bound = (gap - kEvade * options_->neighbour_margin_m) / horizon_s - coming_mps;
    const double least_mps = coming_mps > 0.0 ? -v_max : 0.0;
    if (bound < v_max) lines.buffer[lines.count++] = {towards, std::max(bound, least_mps)};
  }
}

/// The third line: keeps off the neighbour in case it stopped unnoticed, at the worst point for us,
/// which is the nearest point of the segment it has been extrapolated along since it may have
/// stopped. A stopped robot does not approach, so not closing in is enough: the bound is never
/// negative.
std::optional<HalfPlane> SafetyFilter::off_possible_stop(const Vec2& position_m, const Neighbour& n,
                                                         double sum_m) const {
  const Vec2 back = -n.possible_stop_age_s * n.velocity_mps;
  const double share = (position_m - n.position_m).dot(back) / back.squaredNorm();
  const Vec2 offset = n.position_m + std::clamp(share, 0.0, 1.0) * back - position_m;
  const double distance = offset.norm();
  if (distance < 1e-9) return std::nullopt;  // we are where it would be: it drove on
  const double bound = (distance - sum_m - kEvade * options_->neighbour_margin_m) /
                       (2.0 * to_seconds(options_->period) + options_->lag_s);
  if (bound >= options_->speed_max_mps) return std::nullopt;
  return HalfPlane{offset / distance, std::max(bound, 0.0)};
}

/// The time without a state after which the first follower brakes: for each neighbour that this
/// robot moves away from, the third line seen from there. All gaps are multiplied by the distance,
/// which saves the division of each direction.
[[gnu::hot]] Listeners SafetyFilter::listeners(const Vec2& position_m, const Vec2& velocity_mps,
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
    // Which neighbours approach and which are left behind is unpredictable: no branches.
    const double coming_m2ps = positive_part(offset.dot(n.velocity_mps));
    const double spare_m2 = positive_part((gap_m - kept_m) * distance - horizon_s * coming_m2ps);
    const double never_m2 = leaving_m2ps > 0.0 ? 0.0 : kNever_m2;
    found.timeout_s =
        std::min(found.timeout_s, (spare_m2 + never_m2) / std::max(leaving_m2ps, kStopped_m2ps));
  }
  // The follower takes a stop for possible only two periods after the state.
  found.timeout_s += horizon_s - options_->lag_s;
  return found;
}

/// Where the half-planes have no common point: relaxes those from `first` on by the same speed, the
/// least that leaves a common point, found by bisection. Nothing if there is no such speed. Without
/// `closing` only those that ask to withdraw, and none above 0, so that the robot itself closes no
/// gap for it; with it all, without a limit.
std::optional<Vec2> SafetyFilter::least_violation(const Vec2& desired_mps, std::size_t first,
                                                  bool closing, Lines& lines) const {
  const std::span<const HalfPlane> all = lines.all();
  lines.relaxed.assign(all.begin(), all.end());
  const auto relax = [&](double by_mps) {
    for (std::size_t i = first; i < all.size(); ++i) {
      const double bound = all[i].bound_mps;
      lines.relaxed[i].bound_mps = closing       ? bound + by_mps
                                   : bound < 0.0 ? std::min(0.0, bound + by_mps)
                                                 : bound;
    }
    return nearest_velocity(desired_mps, lines.relaxed, options_->speed_max_mps);
  };
  // Relaxed by 2 v_max, none bounds the velocity. Relaxed by `high`, all of them contain u = 0;
  // only those before them, as of an approaching obstacle, can still leave no solution.
  double low = 0.0;
  double high = closing ? 2.0 * options_->speed_max_mps : 0.0;
  for (const HalfPlane& line : all.subspan(first)) high = std::max(high, -line.bound_mps);
  std::optional<Vec2> best = relax(high);
  for (int i = 0; best && i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    if (auto u = relax(middle)) {
      best = u;
      high = middle;
    } else {
      low = middle;
    }
  }
  return best;
}

/// The half-planes of neighbours again, those of uncertain positions last: neighbours that may have
/// stopped unnoticed, and discs. Returns the index of the first of them. O(neighbours).
std::size_t SafetyFilter::collect_uncertain_last(const Vec2& position_m,
                                                 std::span<const Neighbour> neighbours,
                                                 Lines& lines) const {
  const auto is_certain = [](const Neighbour& n) {
    return !n.is_silent && n.possible_stop_age_s <= 0.0;
  };
  lines.sorted.clear();
  std::ranges::copy_if(neighbours, std::back_inserter(lines.sorted), is_certain);
  const std::size_t certain = lines.sorted.size();
  std::ranges::copy_if(neighbours, std::back_inserter(lines.sorted), std::not_fn(is_certain));
  lines.count = lines.obstacles;
  collect_neighbours(position_m, std::span(lines.sorted).first(certain), lines);
  const std::size_t first = lines.count;
  collect_neighbours(position_m, std::span(lines.sorted).subspan(certain), lines);
  return first;
}

/// Where the exact half-planes leave no velocity. Between discs, four steps: uncertain positions
/// give way, at most until the robot closes no gap to them, so that it stands rather than enters a
/// disc to keep off a neighbour that it merely extrapolates; discs alone give way without a limit,
/// as a silent robot may be in them and a neighbour is near where it is extrapolated; all of them
/// give way, at most until the robot closes no gap; and without discs, as everywhere else.
Vec2 SafetyFilter::nearest_relaxed(const Vec2& position_m, const Vec2& desired_mps,
                                   std::span<const Neighbour> neighbours, Lines& lines) const {
  if (lines.bodies < lines.count) {
    const std::size_t uncertain = collect_uncertain_last(position_m, neighbours, lines);
    if (auto u = least_violation(desired_mps, uncertain, false, lines)) return *u;
    if (auto u = least_violation(desired_mps, lines.bodies, true, lines)) return *u;
    if (auto u = least_violation(desired_mps, lines.obstacles, false, lines)) return *u;
    lines.count = lines.bodies;
  }
  return least_violation(desired_mps, lines.obstacles, false, lines).value_or(Vec2::Zero());
}

Vec2 SafetyFilter::stand(const Vec2& position_m, std::span<const Neighbour> neighbours) const {
  Lines& lines = empty_lines();
  collect_obstacles(position_m, lines, true);
  collect_approaching(position_m, neighbours, lines);
  lines.bodies = lines.count;
  if (auto u = nearest_velocity(Vec2::Zero(), lines.all(), options_->speed_max_mps)) return *u;
  return least_violation(Vec2::Zero(), lines.obstacles, false, lines).value_or(Vec2::Zero());
}

/// Solves for the desired velocity first. Where that leaves a robot blocked, it tries the desired
/// velocity turned to the right by growing angles and takes the first that lets it move.
[[gnu::hot]] Vec2 SafetyFilter::filter(const Vec2& position_m, const Vec2& desired_mps,
                                       std::span<const Neighbour> neighbours,
                                       bool gives_way) const {
  Lines& lines = empty_lines();
  collect_obstacles(position_m, lines, false);
  collect_neighbours(position_m, neighbours, lines);
  const auto nearest = [&](const Vec2& wanted_mps) {
    const auto exact = nearest_velocity(wanted_mps, lines.all(), options_->speed_max_mps);
    return exact ? *exact : nearest_relaxed(position_m, wanted_mps, neighbours, lines);
  };
  const Vec2 u = nearest(desired_mps);
  const double desired = desired_mps.norm();
  if (!gives_way || desired < options_->scale * kLeastDesired_mps) return u;
  if (u.dot(desired_mps) > kBlocked * desired * desired) return u;
  Vec2 turned = u;
  for (const double turn_rad : kTurns_rad) {
    const double c = std::cos(turn_rad);
    const double s = std::sin(turn_rad);
    turned = nearest(
        {c * desired_mps.x() + s * desired_mps.y(), c * desired_mps.y() - s * desired_mps.x()});
    if (turned.norm() > kFree * desired) break;
  }
  return turned;
}

}  // namespace swarm::agent
