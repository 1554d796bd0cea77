// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/keeper/plan_keeper.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/base/one_line.hpp"
#include "swarm_core/mission/body_scale.hpp"

namespace swarm::planner {
namespace {

// The launcher's scene is expected right after a start. If it does not arrive within this time, the
// planner publishes its plan without it.
constexpr Duration kSceneTimeout = std::chrono::seconds(3);
// Robots that make no progress for this long are stuck: their own escape manoeuvres have failed by
// then.
constexpr Duration kStuckAfter = std::chrono::seconds(8);
// Share of the swarm that has to be stuck before the planner changes the route.
constexpr double kStuckShare = 0.1;
// The robots' statuses come once a second.
constexpr Duration kJudgePeriod = std::chrono::seconds(1);
// A clock that is slow for shorter than this is not worth an event.
constexpr Duration kSlowFor = std::chrono::seconds(5);
// Robots this far ahead of the clock follow the clock of an earlier planner.
constexpr double kRobotsAhead_s = 1.0;
constexpr std::size_t kNamed = 10;  // robots, in an event
constexpr std::uint32_t kFirstVersion = 1;

}  // namespace

PlanKeeper::PlanKeeper(const Mission& mission, Planner planner, std::uint64_t seed,
                       StageClock clock)
    : mission_(mission),
      seed_(seed),
      clock_(std::move(clock)),
      planner_(std::move(planner)),
      robots_(mission.robots.count, from_seconds(3.0 + 3.0 / mission.link.status_hz),
              length_scale(mission.robots)),
      scene_(first_scene(mission.world.obstacles().size())),
      governor_(mission.plan_clock) {}

Result<void> PlanKeeper::plan_first() {
  Rng rng(seed_);
  auto planned = planner_.plan({mission_.world, mission_.start, mission_.goal}, {rng, clock_});
  if (!planned) return tl::unexpected(planned.error());
  newest_ = {*std::move(planned), {}};
  return {};
}

bool PlanKeeper::take_scene(Scene scene) {
  if (scene_received_ && scene.version <= scene_.version) return false;
  for (const SceneObstacle& o : scene_.obstacles) {
    if (o.owner && !has_body(scene, *o.owner)) returned_.push_back(*o.owner);
  }
  scene_ = std::move(scene);
  scene_received_ = true;
  for (const SceneObstacle& o : scene_.obstacles) {
    if (o.owner) robots_.forget(*o.owner);
  }
  return true;
}

/// Plans for a world: from the robots' positions once they have left their start; before that from
/// the start mixture of the mission, from which their positions were drawn. The seed depends on the
/// number of plans of this planner, so that each has its own random numbers and all are
/// reproducible.
Result<Replan> PlanKeeper::plan_anew(const World& world, std::span<const ReportedRobot> robots) {
  const Mixture& goal = scene_.goal ? *scene_.goal : mission_.goal;
  planner_.set_risk({.alpha = scene_.risk_alpha.value_or(mission_.planner.risk_alpha),
                     .delta_m = mission_.planner.risk_delta_m});
  Rng rng(mix_seed(seed_, version_));
  if (!robots.empty()) {
    return replan(planner_, {world, goal, robots, length_scale(mission_.robots)},
                  mission_.robots.count, {rng, clock_});
  }
  auto planned = planner_.plan({world, mission_.start, goal}, {rng, clock_});
  if (!planned) return tl::unexpected(planned.error());
  return Replan{*std::move(planned), {}};
}

/// Plans around the bodies of failed robots where possible, else without them. A Gaussian is wider
/// than a body: one at a source, at a goal or in a passage may block every plan although single
/// robots can drive around it.
Result<Replan> PlanKeeper::plan_around_bodies(UtcTime utc, std::span<const ReportedRobot> robots,
                                              Step& step) {
  auto planned = plan_anew(world_during(mission_.world, scene_, utc, kReplanPeriod), robots);
  const Scene without = without_bodies(scene_);
  if (planned || without.obstacles.size() == scene_.obstacles.size()) return planned;
  auto through = plan_anew(world_during(mission_.world, without, utc, kReplanPeriod), robots);
  if (!through) return planned;
  if (bodies_left_out_ != scene_.version) {
    step.notices.push_back({true, "bodies-not-planned",
                            fmt::format("no plan gets around the bodies of {} robots, each robot "
                                        "avoids them by itself: {}",
                                        scene_.obstacles.size() - without.obstacles.size(),
                                        one_line(planned.error().message))});
  }
  bodies_left_out_ = scene_.version;
  return through;
}

/// Plans for the present scene and publishes the result. If planning fails the last plan stays in
/// force; the failure is reported once per scene. The last plan of a planner that has just been
/// restarted is the mission's first one: robots that wait for a plan of this planner would hold for
/// good.
void PlanKeeper::try_again(SteadyTime now, UtcTime utc, Step& step) {
  std::vector<ReportedRobot> robots;
  if (is_in_flight(now)) {
    robots = placed(robots_.fresh(now));
    if (robots.empty() || is_waiting_for_robots(now) || is_waiting_for_returned(now)) return;
  }
  returned_.clear();
  returned_at_.reset();
  tried_at_ = now;
  auto planned = plan_around_bodies(utc, robots, step);
  if (!planned) {
    if (version_ == 0 && !scene_.goal) publish(now, 0, step);
    if (failed_scene_ == scene_.version) return;
    failed_scene_ = scene_.version;
    step.notices.push_back(
        {true, "replan-failed", "the last plan stays: " + one_line(planned.error().message)});
    return;
  }
  failed_scene_.reset();
  newest_ = *std::move(planned);
  planned_for_.clear();
  for (const ReportedRobot& robot : robots) planned_for_.push_back(robot.robot);
  // Version 1 is the mission's first plan, and no other plan has the number of one that an earlier
  // planner published: the run directory keeps plans by version.
  version_ = std::max({version_, kFirstVersion, reported_version_});
  if (newest_.planned.excess.by_m > 0.0) {
    step.notices.push_back({true, "plan-excess", describe(newest_.planned.excess)});
  }
  publish(now, scene_.version, step);
}

/// Decides whether to plan now: on a new scene, periodically while obstacles move or the last
/// attempt failed, at the period of the method, and with robots that the last plan lacks. The plan
/// made at the start is published as it is while the scene is the mission's own.
void PlanKeeper::keep_planned(SteadyTime now, UtcTime utc, Step& step) {
  if (!scene_received_ && now - begun_at_ < kSceneTimeout) return;
  const bool published = version_ > 0;
  if (phase_ != MissionPhase::kReady && !published && is_waiting_for_robots(now)) return;
  if (scene_.version == 0 && !published && !is_in_flight_elsewhere(now)) {
    publish(now, scene_.version, step);
    tried_at_ = now;
    return;
  }
  const bool is_new = !published || scene_.version != planned_scene_;
  const bool tried = failed_scene_ == scene_.version;
  const bool due = now - tried_at_ >= kReplanPeriod;
  if ((is_new && (!tried || due)) || (scene_.moves(utc) && due) || is_step_due(now) ||
      lacks_robots(now)) {
    try_again(now, utc, step);
  }
}

/// When many robots are stuck the method may find another route. The median of them, by id, stands
/// for the position of the congestion.
void PlanKeeper::avoid_jams(SteadyTime now, UtcTime utc, Step& step) {
  if (phase_ != MissionPhase::kRunning) return;
  const std::vector<ReportedRobot> stuck = robots_.stuck(now, kStuckAfter);
  if (stuck.empty() || static_cast<double>(stuck.size()) < kStuckShare * mission_.robots.count) {
    return;
  }
  robots_.reset_stuck_timers(now);
  const Vec2& at_m = stuck[stuck.size() / 2].position_m;
  if (!planner_.method().on_congestion(at_m)) return;
  step.notices.push_back(
      {false, "jam",
       fmt::format("{} robots are stuck, about ({:.1f}, {:.1f}) m: the guide takes another route",
                   stuck.size(), at_m.x(), at_m.y())});
  try_again(now, utc, step);
}

/// A new version, made for a scene: its clock starts at 0.
void PlanKeeper::publish(SteadyTime now, std::uint64_t scene_version, Step& step) {
  step.publish = true;
  ++version_;
  governor_.issue(version_, now);
  full_rate_at_ = now;
  for (const PlanWarning& warning : newest_.planned.warnings) {
    step.notices.push_back({true, warning.code, warning.text});
  }
  planned_scene_ = scene_version;
}

PlanKeeper::Step PlanKeeper::step(SteadyTime now, UtcTime utc) {
  Step step;
  governor_.advance(now, phase_ == MissionPhase::kRunning);
  if (robots_have_.plan_version == version_) governor_.catch_up(robots_have_.plan_time_s);
  keep_planned(now, utc, step);
  avoid_jams(now, utc, step);
  keep_clock(now, utc, step);
  return step;
}

/// A planner that was restarted publishes the mission's first plan again, which the robots follow
/// already: its clock goes on where theirs is. The median, so that no single robot moves it.
void PlanKeeper::catch_up(SteadyTime now) {
  if (version_ != 1 || !newest_.entries.empty()) return;
  std::vector<double> times_s;
  for (const ReportedRobot& robot : robots_.fresh(now)) {
    if (robot.plan_version == version_) times_s.push_back(robot.plan_time_s);
  }
  if (times_s.empty()) return;
  const auto middle = times_s.begin() + static_cast<std::ptrdiff_t>(times_s.size() / 2);
  std::nth_element(times_s.begin(), middle, times_s.end());
  if (*middle > governor_.plan_time_s() + kRobotsAhead_s) governor_.catch_up(*middle);
}

/// Events about the clock: robots that it no longer waits for, once each, and a clock that has been
/// slow for a while.
void PlanKeeper::report_clock(SteadyTime now, Step& step) {
  std::vector<RobotId> fresh;  // not reported before
  for (const RobotId robot : governor_.hopeless()) {
    if (hopeless_reported_.insert(robot).second) fresh.push_back(robot);
  }
  if (!fresh.empty()) {
    std::string names;
    for (std::size_t i = 0; i < std::min(kNamed, fresh.size()); ++i) {
      names += fmt::format("{}{}", i == 0 ? "" : ", ", fresh[i].value());
    }
    step.notices.push_back(
        {true, "robots-late",
         fmt::format("{} more robot(s) are over {} s behind the plan, its clock does not wait for "
                     "them: robot {}{}",
                     fresh.size(), mission_.plan_clock.hopeless_lag_s, names,
                     fresh.size() > kNamed ? " …" : "")});
  }
  const bool is_slow = governor_.rate() < 1.0 && phase_ == MissionPhase::kRunning;
  if (!is_slow) full_rate_at_ = now;
  const bool is_slow_for_long = is_slow && now - full_rate_at_ >= kSlowFor;
  if (is_slow_for_long && !slow_reported_) {
    slow_reported_ = true;
    step.notices.push_back(
        {false, "plan-clock-slow",
         fmt::format("the plan waits for the swarm: rate {:.2f}, a lag of "
                     "{:.1f} s at quantile {}",
                     governor_.rate(), governor_.lag_s(), mission_.plan_clock.lag_quantile)});
  } else if (!is_slow && slow_reported_) {
    slow_reported_ = false;
    step.notices.push_back({false, "plan-clock-full", "the plan's clock runs at full rate again"});
  }
}

/// Sets the clock's rate from the reported lags once a second. A reading goes out when version or
/// rate change, and after a jump; in between receivers extrapolate.
void PlanKeeper::keep_clock(SteadyTime now, UtcTime utc, Step& step) {
  if (version_ == 0) return;
  if (now - judged_at_ >= kJudgePeriod && phase_ == MissionPhase::kRunning) {
    judged_at_ = now;
    catch_up(now);
    std::vector<RobotLag> lags;
    for (const ReportedRobot& robot : robots_.fresh(now)) {
      if (!reports_lag(robot)) continue;
      lags.push_back({robot.robot, robot.lag_s, robot.arrived});
    }
    governor_.judge(lags);
    report_clock(now, step);
  }
  const PlanClock clock = governor_.reading(utc);
  // The clock jumps when it catches up after a restart.
  const bool jumped = std::abs(clock_reported_.plan_time_at_s(utc) - clock.plan_time_s) > 0.05;
  if (clock.plan_version == clock_reported_.plan_version && clock.rate == clock_reported_.rate &&
      !jumped) {
    return;
  }
  clock_reported_ = clock;
  step.clock = clock;
}

}  // namespace swarm::planner
