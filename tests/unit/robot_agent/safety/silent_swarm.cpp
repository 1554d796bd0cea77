// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/robot_agent/safety/silent_swarm.hpp"

#include <algorithm>

#include "swarm_core/mission/scene_bodies.hpp"
#include "swarm_core/mission/supervision_times.hpp"
#include "swarm_link/channels/cell_traffic.hpp"

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;

constexpr int kStep_ms = 10;
constexpr int kPeriod_ms = 100;
constexpr int kCommandLasts_ms = 2 * kPeriod_ms;
constexpr int kStatusEvery_ms = 1000;
constexpr int kBeatEvery_ms = 500;
/// Of the mission's defaults: 0.5 s and two periods.
constexpr Duration kExpectedSilence = milliseconds(500 + 2 * kPeriod_ms);
/// Cut off within the expected silence, it drives for 2 s without planner and launcher, and may be
/// connected again just then; it publishes within the expected silence, or its last command ends.
constexpr Duration kStandsAfter = 2 * kExpectedSilence + milliseconds(2000 + kCommandLasts_ms);

Mission mission_of(std::size_t robots) {
  Mission mission;
  mission.robots.count = static_cast<std::uint32_t>(robots);
  mission.robots.radius_m = SilentSwarm::kRadius_m;
  mission.robots.speed_max_mps = SilentSwarm::kSpeed_mps;
  return mission;
}

SafetyOptions safety() {
  return {.radius_m = SilentSwarm::kRadius_m,
          .speed_max_mps = SilentSwarm::kSpeed_mps,
          .period = milliseconds(kPeriod_ms)};
}

NeighbourOptions neighbours(const Mission& mission) {
  return {.radius_m = SilentSwarm::kRadius_m,
          .fleet = Fleet(mission.robots),
          .communication_radius_m = SilentSwarm::kCommunicationRadius_m,
          .reach_growth_mps = 6.0,
          .period = milliseconds(kPeriod_ms),
          .expected_silence =
              from_seconds(mission.link.send_interval_max_s) + milliseconds(2 * kPeriod_ms),
          .forget_after = from_seconds(mission.timing.neighbour_forget_s)};
}

MotionPermit::Options permit(const Mission& mission) {
  return {.period = milliseconds(kPeriod_ms),
          .full_interval =
              from_seconds(mission.link.send_interval_max_s) + milliseconds(2 * kPeriod_ms),
          .cut_off_after = from_seconds(mission.timing.planner_silence_s),
          .rejoin_interval = reported_silence(1000.0 / kStatusEvery_ms) +
                             milliseconds(kStatusEvery_ms + 2 * kBeatEvery_ms)};
}

/// As those of GroupChannelOptions.
constexpr link::CellOptions kGroupCells{
    .cell_size_m = 5.0, .communication_radius_m = 4.0, .join_margin_m = 0.5, .leave_margin_m = 1.5};

}  // namespace

struct SilentSwarm::Robot {
  Robot(RobotId robot, const RobotPart& what, const Mission& mission, const Box& bounds_m)
      : id(robot),
        part(what),
        position_m(what.start_m),
        status_m(what.start_m),
        world(World::make(bounds_m, {}).value()),
        table(neighbours(mission)),
        filter(world, safety()),
        sends(SendOptions{.interval_max = from_seconds(mission.link.send_interval_max_s),
                          .period = milliseconds(kPeriod_ms)}),
        permission(permit(mission)),
        whereabouts(whereabouts_options(mission, 0)),
        silent(silence_options(mission, robot, 1)) {}

  RobotId id;
  RobotPart part;
  Vec2 position_m;
  Vec2 status_m;  // of the last status
  Vec2 velocity_mps = Vec2::Zero();
  int valid_until_ms = 0;
  int status_ms = 0;
  std::uint32_t sequence = 0;
  std::uint64_t scene_version = 0;
  std::optional<SteadyTime> planner_at{};
  std::vector<NeighbourReport> socket{};  // arrived since its last tick
  std::vector<link::LauncherBeat> beats{};
  World world;
  NeighbourTable table;
  SafetyFilter filter;
  SendPolicy sends;
  MotionPermit permission;
  Whereabouts whereabouts;
  SilentRobots silent;
  link::CellInterest interest{kGroupCells};
  link::LeftCells left{};
};

SilentSwarm::SilentSwarm(const Box& bounds_m, const std::vector<RobotPart>& parts, SilenceRule rule,
                         Cells cells)
    : bounds_m_(bounds_m),
      rule_(rule),
      cells_(cells),
      scene_(first_scene(0)),
      oracle_({.robots = parts.size(),
               .radius_m = kRadius_m,
               .speed_mps = kSpeed_mps,
               .expected_silence = kExpectedSilence,
               .stands_after = kStandsAfter}) {
  const Mission mission = mission_of(parts.size());
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    robots_.push_back(std::make_unique<Robot>(RobotId(i), parts[i], mission, bounds_m));
    if (parts[i].rams) oracle_.set_adversarial(i);
  }
}

SilentSwarm::~SilentSwarm() = default;

SteadyTime SilentSwarm::time() const { return SteadyTime(milliseconds(100'000 + now_ms_)); }

SilentSwarm::Approach SilentSwarm::fly_until(int end_ms) {
  Approach nearest;
  for (; now_ms_ < end_ms && nearest.gap_m > 0.0; now_ms_ += kStep_ms) {
    launch();
    for (const auto& robot : robots_) {
      const bool is_frozen = robot->part.frozen.covers(now_ms_);
      oracle_.set_unable(robot->id.value(), is_frozen && now_ms_ >= robot->valid_until_ms);
      if (now_ms_ % kPeriod_ms == robot->part.phase_ms && !is_frozen) tick(*robot);
    }
    move(nearest);
  }
  return nearest;
}

/// Takes what has waited since the last tick, as a process does.
void SilentSwarm::receive(Robot& robot) {
  const SteadyTime now = time();
  if (!robot.part.cut_off.covers(now_ms_)) {
    robot.planner_at = now;
    if (robot.scene_version != scene_.version) {
      robot.scene_version = scene_.version;
      const World empty = World::make(bounds_m_, {}).value();
      robot.world = world_at(empty, without_bodies_of(scene_, robot.id, 1), UtcTime{});
      robot.whereabouts.on_scene(scene_);
    }
  }
  for (const link::LauncherBeat& beat : robot.beats) {
    const SteadyTime sent{Duration(beat.sent_ns)};
    if (robot.whereabouts.on_beat(beat, now, sent) && cells_ != Cells::kNoLateRobots) {
      robot.silent.on_beat(beat, sent);
    }
  }
  for (const NeighbourReport& report : robot.socket) {
    robot.table.take(report, robot.position_m, now - report.as_of);
    robot.silent.on_state({report.robot, report.as_of, report.position_m});
    oracle_.on_received(robot.id.value(), report.robot.value(), report.as_of, report.position_m);
  }
  oracle_.on_tick(robot.id.value(), now, robot.position_m);
  robot.beats.clear();
  robot.socket.clear();
  SilentRobots::ReceivesAt receives_at;
  if (cells_ == Cells::kLeftIsElsewhere || cells_ == Cells::kNoLateRobots) {
    receives_at = [&](const Vec2& position_m) { return robot.interest.covers(position_m); };
  }
  robot.silent.update(now, robot.whereabouts, receives_at);
  robot.interest.update({&robot.position_m, 1});
}

/// Straight to the goal, or to another robot, at full speed: the worst method above the filter.
Vec2 SilentSwarm::desired_mps(const Robot& robot) const {
  const Vec2 goal_m = robot.part.rams ? robots_[*robot.part.rams]->position_m : robot.part.goal_m;
  const Vec2 path_m = goal_m - robot.position_m;
  const double far_m = path_m.norm();
  if (far_m < 1e-9) return Vec2::Zero();
  const double speed_mps = robot.part.rams ? kSpeed_mps : std::min(kSpeed_mps, 2.0 * far_m);
  return path_m * (speed_mps / far_m);
}

void SilentSwarm::tick(Robot& robot) {
  receive(robot);
  const SteadyTime now = time();
  const StandReason reason =
      robot.permission.update({.now = now,
                               .planner = robot.planner_at,
                               .launcher = robot.whereabouts.last_beat(),
                               .is_obstacle = robot.whereabouts.is_obstacle(robot.id)});
  const bool keeps = rule_ == SilenceRule::kKeep;
  const Neighbourhood near = robot.table.at(now, robot.position_m, keeps ? &robot.silent : nullptr);
  const bool gives_way = (robot.part.goal_m - robot.position_m).norm() > 2.0;
  Vec2 velocity_mps =
      near.is_within_silent
          ? robot.filter.stand(robot.position_m, near.close)
          : robot.filter.filter(robot.position_m, desired_mps(robot), near.close, gives_way);
  if (robot.part.rams) velocity_mps = desired_mps(robot);
  if (reason != StandReason::kNone) velocity_mps = Vec2::Zero();
  robot.velocity_mps = velocity_mps;
  robot.valid_until_ms = now_ms_ + kCommandLasts_ms;
  const SendInput state{
      .now = now,
      .position_m = robot.position_m,
      .velocity_mps = velocity_mps,
      .listeners = robot.filter.listeners(robot.position_m, velocity_mps, near.close),
      .link = robot.table.link()};
  if (robot.sends.must_send(state)) {
    robot.sends.record_sent(state);
    publish(robot, velocity_mps);
  }
  if (!is_lost(robot) && now_ms_ % kStatusEvery_ms == robot.part.phase_ms) {
    robot.status_ms = now_ms_;
    robot.status_m = robot.position_m;
  }
}

void SilentSwarm::publish(Robot& robot, const Vec2& velocity_mps) {
  ++robot.sequence;
  const double size_m = kGroupCells.cell_size_m;
  const auto left = robot.left.update(robot.id.value(), link::cell_of(robot.position_m, size_m));
  const auto receives = [&](const Robot& other) {
    if (cells_ == Cells::kOne || other.interest.covers(robot.position_m)) return true;
    return left && other.interest.covers(size_m * Vec2(left->x + 0.5, left->y + 0.5));
  };
  for (const auto& other : robots_) {
    if (other->id == robot.id || !receives(*other)) continue;
    if (is_lost(robot) || other->part.cut_off.covers(now_ms_)) {
      oracle_.on_lost(other->id.value(), robot.id.value());
    } else {
      other->socket.push_back({robot.id, robot.sequence, time(), robot.position_m, velocity_mps});
    }
  }
}

/// Whether nothing that it sends reaches others.
bool SilentSwarm::is_lost(const Robot& sender) const {
  return sender.part.cut_off.covers(now_ms_) || sender.part.mute.covers(now_ms_);
}

/// A circle that covers a body, as wide as the launcher makes it. Of one that is cut off it knows
/// the last status: the robot was cut off at most a period later, and drove on until it held. Of
/// others it reads the log, which ends where the robot froze, but may lack what a process had not
/// written.
Circle SilentSwarm::fallen(const Robot& robot) const {
  constexpr int kHolds_ms = 2000;
  const bool is_cut_off = robot.part.cut_off.covers(now_ms_);
  const bool drives = now_ms_ < robot.valid_until_ms;
  if (!is_cut_off && drives) {
    const Vec2 half_m = 0.0005 * kCommandLasts_ms * robot.velocity_mps;
    return {robot.position_m + half_m, kRadius_m + half_m.norm()};
  }
  const int drives_ms = kStatusEvery_ms + kCommandLasts_ms + (is_cut_off ? kHolds_ms : 0);
  return {is_cut_off ? robot.status_m : robot.position_m,
          kRadius_m + 0.001 * drives_ms * kSpeed_mps};
}

/// The launcher: beats, and the bodies of silent robots.
void SilentSwarm::launch() {
  if (now_ms_ % kBeatEvery_ms != 0) return;
  constexpr double kStatus_hz = 1000.0 / kStatusEvery_ms;
  std::vector<RobotId> silent;
  std::vector<link::LateRobot> late;
  for (const auto& robot : robots_) {
    const int silence_ms = now_ms_ - robot->status_ms;
    const bool is_silent = milliseconds(silence_ms) > reported_silence(kStatus_hz);
    if (milliseconds(silence_ms) > late_status(kStatus_hz)) {
      late.push_back({.robot = robot->id.value(),
                      .age_ms = static_cast<std::uint32_t>(silence_ms),
                      .x_m = robot->status_m.x(),
                      .y_m = robot->status_m.y()});
    }
    if (is_silent) silent.push_back(robot->id);
    if (is_silent == has_body(scene_, robot->id)) continue;
    const SceneChange change = is_silent ? SceneChange(AddBody{robot->id, fallen(*robot)})
                                         : SceneChange(ClearBody{robot->id});
    const World empty = World::make(bounds_m_, {}).value();
    if (auto next = after(scene_, change, empty, UtcTime(milliseconds(1 + now_ms_)))) {
      scene_ = *std::move(next);
    }
  }
  ++beat_.sequence;
  link::set_silent(beat_, silent);
  link::set_late(beat_, late);
  beat_.sent_ns = time().time_since_epoch().count();
  for (const auto& robot : robots_) {
    if (!robot->part.cut_off.covers(now_ms_)) robot->beats.push_back(beat_);
  }
}

/// Within a step no velocity changes: the least distance of two straight motions is known.
void SilentSwarm::move(Approach& nearest) {
  constexpr double kStep_s = 0.001 * kStep_ms;
  std::vector<Vec2> moved_m;
  for (const auto& robot : robots_) {
    const bool drives = now_ms_ < robot->valid_until_ms;
    moved_m.push_back(drives ? Vec2(kStep_s * robot->velocity_mps) : Vec2::Zero());
  }
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Vec2 apart_m = robots_[i]->position_m - robots_[j]->position_m;
      const Vec2 by_m = moved_m[i] - moved_m[j];
      const double length = by_m.squaredNorm();
      const double share = length > 0.0 ? std::clamp(-apart_m.dot(by_m) / length, 0.0, 1.0) : 0.0;
      const double gap_m = (apart_m + share * by_m).norm() - 2 * kRadius_m;
      if (gap_m >= nearest.gap_m) continue;
      nearest = {gap_m, j, i, now_ms_, gap_m <= 0.0 && oracle_.counts(i, j)};
    }
  }
  for (std::size_t i = 0; i < robots_.size(); ++i) robots_[i]->position_m += moved_m[i];
}

}  // namespace swarm::agent
