// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/neighbours/whereabouts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "swarm_core/mission/supervision_times.hpp"

namespace swarm::agent {

Whereabouts::Whereabouts(const WhereaboutsOptions& options)
    : options_(options), listed_at_(options.robots), late_in_(options.robots) {}

bool Whereabouts::is_valid(const link::LauncherBeat& beat) const {
  const auto has_known_ids = [&](const link::RobotRange& range) {
    return std::uint64_t{range.first} + range.count <= options_.robots;
  };
  const auto is_known = [&](const link::LateRobot& late) {
    return late.robot < options_.robots && std::isfinite(late.x_m) && std::isfinite(late.y_m);
  };
  return std::ranges::all_of(beat.silent(), has_known_ids) &&
         std::ranges::all_of(beat.late(), is_known);
}

/// After a gap any number passes: an invented one must not keep the real ones out for ever.
bool Whereabouts::is_newer(const link::LauncherBeat& beat, SteadyTime now, SteadyTime sent) const {
  if (sent > now + options_.clock_skew || sent < now - options_.clock_skew) return false;
  const bool is_gap = last_beat_ && now - *last_beat_ > options_.beat_timeout;
  return beat.sequence > sequence_ || (is_gap && beat.sequence > 0);
}

/// A beat that does not list all silent robots is a sign of life, but ends what earlier ones state.
bool Whereabouts::on_beat(const link::LauncherBeat& beat, SteadyTime now, SteadyTime sent) {
  if (beat.run != options_.run || !is_newer(beat, now, sent) || !is_valid(beat)) {
    ++refused_;
    return false;
  }
  sequence_ = beat.sequence;
  if (last_beat_ && now - *last_beat_ > options_.beat_timeout) back_at_ = now;
  if (!beat.lists_all || !last_beat_ || now - *last_beat_ > options_.beat_timeout) since_ = now;
  last_beat_ = now;
  for (const link::RobotRange& range : beat.silent()) {
    std::fill_n(listed_at_.begin() + range.first, range.count, now);
    std::fill_n(late_in_.begin() + range.first, range.count, sequence_);
  }
  for (const link::LateRobot& late : beat.late()) late_in_[late.robot] = sequence_;
  // A robot that has been silent for long is in the other list, if that has room for it.
  const bool has_room = beat.lists_all || beat.ranges < link::LauncherBeat::kMaxRanges;
  lists_all_late_ = beat.lists_all_late && has_room;
  complete_sent_ = beat.lists_all && beat.lists_all_late ? std::min(sent, now) : SteadyTime{};
  return true;
}

void Whereabouts::on_scene(const Scene& scene) {
  bodies_.clear();
  for (const SceneObstacle& obstacle : scene.obstacles) {
    if (!obstacle.owner) continue;
    const auto* circle = std::get_if<Circle>(&obstacle.shape);
    constexpr double kUnknown_m = std::numeric_limits<double>::infinity();
    bodies_.push_back({*obstacle.owner, circle != nullptr ? circle->radius_m : kUnknown_m});
  }
  std::ranges::sort(bodies_, {}, &Body::robot);
}

std::optional<double> Whereabouts::obstacle_radius_m(RobotId robot) const {
  const auto at = std::ranges::lower_bound(bodies_, robot, {}, &Body::robot);
  if (at == bodies_.end() || at->robot != robot) return std::nullopt;
  return at->radius_m;
}

bool Whereabouts::is_well(RobotId robot, SteadyTime last_state, SteadyTime now) const {
  if (!last_beat_ || now - *last_beat_ > options_.beat_timeout) return false;
  if (robot.value() >= listed_at_.size()) return false;
  const SteadyTime begin = std::max({last_state, since_, listed_at_[robot.value()]});
  return *last_beat_ - begin >= options_.healthy_after;
}

bool Whereabouts::may_be_late(RobotId robot, SteadyTime now) const {
  if (!last_beat_ || now - *last_beat_ > options_.beat_timeout || !lists_all_late_) return true;
  return robot.value() >= late_in_.size() || late_in_[robot.value()] == sequence_;
}

bool Whereabouts::is_alive(RobotId robot, SteadyTime last_state, SteadyTime now) const {
  return !may_be_late(robot, now) && complete_sent_ - last_state >= options_.alive_after;
}

WhereaboutsOptions whereabouts_options(const Mission& mission, std::uint64_t run) {
  const Duration beat = from_seconds(1.0 / kBeatHz);
  return {.robots = mission.robots.count,
          .run = run,
          .beat_timeout = 3 * beat,
          .launcher_silence = from_seconds(mission.timing.launcher_silence_s),
          .clock_skew = from_seconds(mission.timing.clock_skew_refuse_s),
          // The last status may have been sent just before the robot was cut off, the beat that
          // lists it follows up to a period later, and may wait in a socket for up to a gap.
          .healthy_after = reported_silence(mission.link.status_hz) +
                           from_seconds(1.0 / mission.link.status_hz) + 4 * beat,
          .alive_after =
              late_status(mission.link.status_hz) + from_seconds(mission.timing.clock_skew_warn_s)};
}

}  // namespace swarm::agent
