// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "robot_agent/methods/shared/attraction.hpp"
#include "swarmflow/robot/schedule.hpp"

namespace swarm::agent {

/// Gains and limits of the pace.
struct PaceOptions {
  double look_ahead_s = 6.0;      ///< T: the carrot is this far ahead in plan time
  double gain_hz = 0.3;           ///< k
  double approach_gain_hz = 0.8;  ///< slows down before the end of the path
  double cruise_mps = 1.45;       ///< largest desired speed
};

/// Keeps a robot in time with the plan. At plan time τ it is to be at the arc length l*(τ) of its
/// path; it drives towards a carrot at c = l*(τ + τ̇ T), at the speed
///
///   v = l*′(τ) τ̇ + k e,    e = l*(τ) − s,    s = c − w
///
/// w [m] is what it still has to drive to the carrot, the straight part to its aim point and the
/// rest along the path, so that cutting a corner makes it early and pacing takes that back. l*′ is
/// the mean over the next kFeed_s, so that a robot does not start with a jerk when a wait ends.
class Pace {
 public:
  static constexpr double kFeed_s = 1.0;
  /// A robot this far past the carrot returns to it, at this speed at most; for default bodies.
  static constexpr double kPast_m = 0.8;
  static constexpr double kReturn_mps = 0.5;

  /// The pace at one plan time.
  struct Now {
    double reference_m = 0.0;  ///< l*(τ)
    double carrot_m = 0.0;     ///< c
    double feed_mps = 0.0;     ///< l*′(τ) τ̇
    bool is_last = false;      ///< the carrot is the end of the path
  };

  Pace() = default;
  Pace(Schedule schedule, double length_m) : schedule_(std::move(schedule)), length_m_(length_m) {}

  Now at(const PlanTime& t, const PaceOptions& options) const {
    const double reference_m = schedule_.at_m(t.plan_time_s);
    const double soon_m = schedule_.at_m(t.plan_time_s + t.rate * kFeed_s);
    const double carrot_m = schedule_.at_m(t.plan_time_s + t.rate * options.look_ahead_s);
    return {.reference_m = reference_m,
            .carrot_m = carrot_m,
            .feed_mps = (soon_m - reference_m) / kFeed_s,
            .is_last = carrot_m >= length_m_ - 1e-6};
  }

  /// Speed as a function of the distance to the aim; from there `rest_m` along the path lead to the
  /// carrot.
  static AttractionSpeed speed(const Now& now, double rest_m, const PaceOptions& options) {
    // s = c − (d + rest), so e = l* − c + rest + d.
    AttractionSpeed speed{
        .pace_mps = now.feed_mps + options.gain_hz * (now.reference_m - now.carrot_m + rest_m),
        .pace_hz = options.gain_hz,
        .cruise_mps = options.cruise_mps};
    if (!now.is_last) return speed;
    // The reference has reached the end already: the robot approaches as without a clock.
    if (now.feed_mps <= 0.0) {
      speed.pace_mps = options.approach_gain_hz * rest_m;
      speed.pace_hz = options.approach_gain_hz;
      return speed;
    }
    speed.approach_mps = options.approach_gain_hz * rest_m;
    speed.approach_hz = options.approach_gain_hz;
    return speed;
  }

  /// Plan time by which a robot at this arc length is behind.
  double lag_s(const PlanTime& t, double at_m) const {
    return schedule_.lag_s(t.plan_time_s, at_m);
  }

 private:
  Schedule schedule_;
  double length_m_ = 0.0;
};

}  // namespace swarm::agent
