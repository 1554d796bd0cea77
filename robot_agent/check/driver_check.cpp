// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/check/driver_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "robot_agent/check/driver_trial.hpp"
#include "swarmflow/mission/body_limits.hpp"

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Verdict = ClauseResult::Verdict;

// Bodies creep and measurements are rounded.
constexpr double kStill_m = 0.03;
// Of a commanded distance, where the direction is right.
constexpr double kLeastShare = 0.5;
constexpr double kMostShare = 1.4;
constexpr double kMostAngle_rad = 0.5;
// Calls that may be slow: the machine's scheduler delays some.
constexpr double kSlowShare = 0.02;

/// The check of one driver, clause by clause.
class DriverCheck {
 public:
  DriverCheck(const MakeDriver& make, const DriverCheckOptions& options, CheckClock& clock)
      : make_(make), options_(options), clock_(clock) {}

  std::vector<ClauseResult> run() {
    if (start("start")) {
      if (has_position()) {
        trial_->enter_room();
        if (lifts_off()) try_clauses();
        come_to_rest();
      }
      makes_sense();
    }
    const bool is_restarted = driver_ != nullptr && (!trial_ || trial_->ended().empty());
    end();
    if (is_restarted) {
      if (start("restart")) has_position();
      end();
    }
    return std::move(results_);
  }

 private:
  /// One clause after the other, until one ends the check.
  void try_clauses() {
    using Clause = void (DriverCheck::*)();
    static constexpr std::array<Clause, 7> kClauses{&DriverCheck::stands_still,
                                                    &DriverCheck::moves_as_commanded,
                                                    &DriverCheck::stops_by_itself,
                                                    &DriverCheck::stops_in_a_frozen_process,
                                                    &DriverCheck::holds_and_goes_on,
                                                    &DriverCheck::reports_a_lost_position,
                                                    &DriverCheck::lands};
    for (const Clause clause : kClauses) {
      const std::size_t before = results_.size();
      (this->*clause)();
      if (trial_->ended().empty()) continue;
      results_.resize(before);  // what it measured is not that of a whole trial
      const bool left = trial_->ended().starts_with("it left");
      report("room", left ? Verdict::kBroken : Verdict::kNotTried, trial_->ended());
      return;
    }
  }

  /// However the clauses ended.
  void come_to_rest() {
    const bool may_fly = abilities_.flies && trial_->health().is_flying != false;
    trial_->stop(may_fly ? StopKind::kLand : StopKind::kHold, may_fly ? seconds(5) : stopping());
  }

  void report(std::string_view clause, Verdict verdict, std::string text) {
    results_.push_back({.clause = clause, .verdict = verdict, .text = std::move(text)});
  }
  bool judge(std::string_view clause, bool is_kept, std::string text) {
    report(clause, is_kept ? Verdict::kKept : Verdict::kBroken, std::move(text));
    return is_kept;
  }

  /// Longest time from a command's end to rest.
  Duration stopping() const { return abilities_.stops_within + from_seconds(options_.lag_s); }
  double tolerance_m() const { return kStill_m + 6.0 * options_.noise_m; }

  bool start(std::string_view clause) {
    auto made = make_();
    if (!made) return judge(clause, false, "it is not made: " + made.error().message);
    driver_ = *std::move(made);
    if (const auto started = driver_->start(); !started) {
      return judge(clause, false, "it does not start: " + started.error().message);
    }
    abilities_ = driver_->abilities();
    trial_.emplace(*driver_, options_, clock_);
    return judge(clause, true, "started");
  }

  void end() {
    trial_.reset();
    if (driver_ != nullptr) driver_->shutdown();
    driver_.reset();
  }

  bool has_position() {
    const bool is_found = trial_->wait(options_.connects_within, [&](const Measurement& m) {
      return pose_fault(m, options_.pose).empty();
    });
    return judge("position", is_found,
                 is_found
                     ? fmt::format("at ({:.2f}, {:.2f}) m", trial_->position_m().x(),
                                   trial_->position_m().y())
                     : fmt::format("none within {:g} s", to_seconds(options_.connects_within)));
  }

  bool lifts_off() {
    for (const Manoeuvre what : {Manoeuvre::kArm, Manoeuvre::kTakeOff}) {
      if (what == Manoeuvre::kTakeOff && !abilities_.flies) break;
      if (const auto begun = driver_->begin(what); !begun) {
        report("arm", Verdict::kNotTried, "it refuses: " + begun.error().message);
        return false;
      }
    }
    const bool is_up = trial_->wait(options_.lifts_within, [&](const Measurement&) {
      const DriverHealth& health = trial_->health();
      return health.is_armed.value_or(true) && (!abilities_.flies || health.is_flying == true);
    });
    return judge("arm", is_up,
                 is_up ? "ready to move"
                       : fmt::format("not ready after {:g} s", to_seconds(options_.lifts_within)));
  }

  void stands_still() {
    const Vec2 before = trial_->position_m();
    trial_->idle(seconds(1));
    const double moved_m = (trial_->position_m() - before).norm();
    judge("rest", moved_m <= tolerance_m(),
          fmt::format("moved {:.3f} m in 1 s without a command", moved_m));
  }

  /// Along both axes and back: a body frame, north-east-down or degrees come to light.
  void moves_as_commanded() {
    const double distance_m = 0.5 * options_.room_m;
    const Duration span = from_seconds(distance_m / options_.speed_mps);
    static constexpr std::array<std::pair<double, double>, 4> kSides{
        {{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
    bool is_kept = true;
    std::string text;
    for (const auto& [x, y] : kSides) {
      const Vec2 to(x, y);
      // Turned and up to speed.
      trial_->drive(options_.speed_mps * to, from_seconds(options_.lag_s) + 2 * options_.period);
      const Vec2 before = trial_->position_m();
      trial_->drive(options_.speed_mps * to, span);
      const Vec2 moved = trial_->position_m() - before;
      trial_->stop(StopKind::kHold, stopping());
      const double along_m = moved.dot(to);
      const double angle_rad =
          std::abs(std::atan2(to.x() * moved.y() - to.y() * moved.x(), along_m));
      const bool is_right = along_m >= kLeastShare * distance_m - tolerance_m() &&
                            along_m <= kMostShare * distance_m + tolerance_m() &&
                            (angle_rad <= kMostAngle_rad || moved.norm() <= tolerance_m());
      if (!is_right && is_kept) {
        text = fmt::format("commanded {:.2f} m along ({:g}, {:g}), moved ({:.2f}, {:.2f}) m",
                           distance_m, x, y, moved.x(), moved.y());
      }
      is_kept = is_kept && is_right;
    }
    can_drive_ = judge("frames", is_kept,
                       is_kept ? fmt::format("{:.2f} m in four directions", distance_m) : text);
  }

  /// One command, then measurements alone.
  void stops_by_itself() {
    if (!can_drive_) return report("watchdog", Verdict::kNotTried, "it does not drive");
    stops_alone_ = coast("watchdog", [&](Duration span) { trial_->idle(span); });
  }
  void stops_in_a_frozen_process() {
    if (!can_drive_) return report("frozen", Verdict::kNotTried, "it does not drive");
    if (!stops_alone_) return report("frozen", Verdict::kNotTried, "its watchdog is broken");
    coast("frozen", [&](Duration span) { trial_->freeze(span); });
  }

  template <class Pass>
  bool coast(std::string_view clause, Pass pass) {
    const Vec2 velocity = drive_up();
    const Vec2 before = trial_->position_m();
    pass(2 * options_.period + stopping());
    trial_->tick();
    const Vec2 stopped = trial_->position_m();
    pass(seconds(2));
    trial_->tick();
    const double coasted_m = (stopped - before).norm();
    const double after_m = (trial_->position_m() - stopped).norm();
    const double most_m =
        velocity.norm() * to_seconds(3 * options_.period + stopping()) + tolerance_m();
    const bool is_kept = judge(
        clause, coasted_m <= most_m && after_m <= tolerance_m(),
        fmt::format("{:.3f} m until it stopped, {:.3f} m in 2 s after that", coasted_m, after_m));
    come_back();
    return is_kept;
  }

  /// Up to speed, away from where the last trial of this kind went.
  Vec2 drive_up() {
    side_ = -side_;
    const Vec2 velocity(side_ * options_.speed_mps, 0);
    trial_->drive(velocity, from_seconds(options_.lag_s) + 5 * options_.period);
    return velocity;
  }
  void come_back() {
    const Vec2 velocity(-side_ * options_.speed_mps, 0);
    trial_->drive(velocity, from_seconds(options_.lag_s) + 5 * options_.period);
    trial_->stop(StopKind::kHold, stopping());
  }

  void holds_and_goes_on() {
    if (!can_drive_) return report("hold", Verdict::kNotTried, "it does not drive");
    drive_up();
    trial_->stop(StopKind::kHold, stopping());
    const Vec2 stopped = trial_->position_m();
    trial_->stop(StopKind::kHold, seconds(2));
    const double crept_m = (trial_->position_m() - stopped).norm();
    const bool is_held = judge("hold", crept_m <= tolerance_m(),
                               fmt::format("moved {:.3f} m in 2 s of a stop", crept_m));
    const Vec2 before = trial_->position_m();
    come_back();
    const double back_m = (trial_->position_m() - before).norm();
    if (is_held) {
      judge("go-on", back_m > tolerance_m(),
            fmt::format("moved {:.3f} m when commanded after a stop", back_m));
    }
  }

  void reports_a_lost_position() {
    if (!options_.cut_pose) {
      return report("lost-pose", Verdict::kNotTried, "nothing is given that cuts the localisation");
    }
    if (!options_.cut_pose(true)) {
      options_.cut_pose(false);
      return report("lost-pose", Verdict::kNotTried, "the localisation could not be cut");
    }
    const auto is_located = [&](const Measurement& m) {
      return pose_fault(m, options_.pose).empty();
    };
    const bool is_reported = trial_->wait(options_.pose.timeout + seconds(1),
                                          [&](const Measurement& m) { return !is_located(m); });
    if (!options_.cut_pose(false)) {
      return report("lost-pose", Verdict::kNotTried, "the localisation could not be given back");
    }
    const bool is_back = trial_->wait(options_.connects_within, is_located);
    judge("lost-pose", is_reported && is_back,
          !is_reported ? "it goes on to report a position without localisation"
          : is_back    ? "reported, and back with the localisation"
                       : "no position after the localisation was back");
  }

  void lands() {
    trial_->stop(StopKind::kLand, options_.period * 5);
    if (abilities_.flies) {
      const bool is_down = trial_->wait(options_.lifts_within, [&](const Measurement&) {
        driver_->stop(clock_.now(), StopKind::kLand);
        return trial_->health().is_flying == false;
      });
      judge("land", is_down, is_down ? "landed" : "it still flies");
    }
    if (!options_.may_kill) {
      return report("kill", Verdict::kNotTried, "not allowed to cut the motors");
    }
    const Vec2 before = trial_->position_m();
    trial_->stop(StopKind::kKill, seconds(1));
    const double moved_m = (trial_->position_m() - before).norm();
    const bool is_armed = driver_->health().is_armed == true;
    judge("kill", moved_m <= tolerance_m() && !is_armed,
          fmt::format("moved {:.3f} m{}", moved_m, is_armed ? ", and its motors are armed" : ""));
  }

  void makes_sense() {
    judge("sense", trial_->nonsense().empty(),
          trial_->nonsense().empty() ? "all that it reported" : trial_->nonsense());
    judge("blocking", trial_->slow_calls() <= kSlowShare * trial_->calls(),
          fmt::format("{} of {} calls took longer than half a period", trial_->slow_calls(),
                      trial_->calls()));
  }

  const MakeDriver& make_;
  const DriverCheckOptions& options_;
  CheckClock& clock_;
  std::unique_ptr<Driver> driver_;
  BodyAbilities abilities_;
  std::optional<DriverTrial> trial_;
  std::vector<ClauseResult> results_;
  bool can_drive_ = false;
  bool stops_alone_ = false;
  double side_ = -1.0;
};

}  // namespace

DriverCheckOptions DriverCheckOptions::of(const Mission& mission, RobotId robot) {
  const BodySpec& body = body_of(mission.robots, robot);
  DriverCheckOptions options;
  options.period = from_seconds(1.0 / mission.control.rate_hz);
  options.speed_mps = std::min(options.speed_mps, body.speed_max_mps);
  options.lag_s = body_lag_s(body);
  options.noise_m = body.position_noise_m + body.motion_noise_m;
  options.pose = PoseLimits::of(body);
  return options;
}

std::vector<ClauseResult> check_driver(const MakeDriver& make, const DriverCheckOptions& options,
                                       CheckClock& clock) {
  return DriverCheck(make, options, clock).run();
}

}  // namespace swarm::agent
