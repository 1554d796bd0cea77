// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/program/process_loop.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/base/stamp.hpp"
#include "swarm_core/mission/scene_bodies.hpp"
#include "swarm_core/mission/supervision_times.hpp"

namespace swarm::agent {
namespace {

/// After a gap of the launcher, whose discovery server matched no endpoints meanwhile: on a loaded
/// machine it has been seen to take 14 s for what had waited.
constexpr Duration kDiscoveryLag = std::chrono::seconds(60);

/// After a silence of the planner, robots wait for as long as a neighbour may be silent, plus two
/// periods (see MissionWatch).
Inbox make_inbox(const Mission& mission, Readers readers, link::StateChannel& states) {
  const Duration silence = from_seconds(mission.timing.planner_silence_s);
  const double resume_delay_s = mission.link.send_interval_max_s + 2.0 / mission.control.rate_hz;
  return {std::move(readers),
          states,
          link::wire_limits(mission),
          MissionWatch(silence, from_seconds(resume_delay_s)),
          silence,
          largest_communication_radius_m(mission)};
}

/// A process stands after the silence that makes it hold, if the launcher is silent as well.
MotionPermit::Options permit_options(const Mission& mission, bool in_flight) {
  const Duration period = from_seconds(1.0 / mission.control.rate_hz);
  return {.period = period,
          .full_interval = from_seconds(mission.link.send_interval_max_s) + 2 * period,
          .cut_off_after = from_seconds(mission.timing.planner_silence_s),
          .rejoin_interval = reported_silence(mission.link.status_hz) +
                             from_seconds(1.0 / mission.link.status_hz) +
                             from_seconds(2.0 / kBeatHz),
          .in_flight = in_flight};
}

/// The bus as one robot of the process sees it.
struct RobotBus {
  const ReceivedCells& received;
  RobotId self;
  EchoGuard& echo;
  std::vector<link::RobotStateMessage>& published;

  template <class Take>
  void receive(const Vec2& position_m, Take take) const {
    received.visit_near(position_m, [&](const ReceivedState& state) {
      if (state.report.robot != self) take(state.report, state.age);  // not its own echo
    });
  }
  void publish(const link::RobotStateMessage& state) const {
    echo.record_sent(state);
    published.push_back(state);
  }
};

}  // namespace

ProcessLoop::ProcessLoop(const Mission& mission, std::unique_ptr<World> world, LocalRobots robots,
                         BusAccess bus)
    : mission_(mission),
      period_(from_seconds(1.0 / mission.control.rate_hz)),
      world_(std::move(world)),
      local_(std::move(robots)),
      bus_(std::move(bus)),
      inbox_(make_inbox(mission, std::move(bus_.readers), *bus_.states)),
      whereabouts_(whereabouts_options(mission, bus_.run)),
      silent_(silence_options(mission, local_.robots.front().loop.id(),
                              static_cast<std::uint32_t>(local_.robots.size()))),
      permit_(permit_options(mission, local_.any_is_underway)),
      plans_(local_.any_is_underway),
      status_(mission, *bus_.status),
      events_(local_.robots, *bus_.event),
      density_(mission, local_.read_density) {}

/// Receives once for all robots.
void ProcessLoop::receive(const Time& time) {
  std::vector<LocalRobot>& robots = local_.robots;
  bus_.participant->receive();
  inbox_.receive(time.now, time.utc_now, [&](RobotId id) -> const EchoGuard* {
    // Ids below the first wrap around to large offsets.
    const std::uint32_t offset = id.value() - robots.front().loop.id().value();
    return offset < robots.size() ? &robots[offset].echo : nullptr;
  });
  if (bus_.stops) {
    if (const auto stop = bus_.stops->take()) inbox_.receive(*stop, time.utc_now);
    for (const link::LauncherBeat& beat : bus_.stops->beats()) {
      // By the run's clock. Another number is as old as can be: it is refused.
      const UtcTime sent_utc(is_stamp(beat.sent_ns) ? Duration(beat.sent_ns) : Duration::zero());
      const SteadyTime sent = time.now - (time.utc_now - sent_utc);
      if (whereabouts_.on_beat(beat, time.now, sent)) {
        silent_.on_beat(beat, std::min(sent, time.now));
      }
    }
    inbox_.count_stop_channel(bus_.stops->undecodable(), whereabouts_.refused());
  }
}

/// After the beats of this tick, which may clear robots.
void ProcessLoop::find_silent(SteadyTime now) {
  for (const ReceivedState& state : inbox_.states()) {
    silent_.on_state({.robot = state.report.robot,
                      .as_of = state.report.as_of,
                      .position_m = state.report.position_m});
  }
  silent_.update(now, whereabouts_,
                 [this](const Vec2& position_m) { return bus_.states->receives_at(position_m); });
}

/// Whether the robots may move at all. None does before the start: processes are still starting,
/// and a robot that makes room for another could touch one that is not received yet.
bool ProcessLoop::may_move(SteadyTime now, UtcTime utc_now) {
  const StandReason reason = permit_.update({.now = now,
                                             .planner = inbox_.mission().planner_received_at(),
                                             .launcher = whereabouts_.last_beat(),
                                             .all_cells = bus_.states->receives_all(),
                                             .is_obstacle = is_obstacle(),
                                             .lacks_files = bus_.states->lacks_files()});
  events_.on_permit(now, utc_now, reason);
  return reason == StandReason::kNone && inbox_.mission().phase() != MissionPhase::kReady;
}

/// Whether the launcher has made a robot of the process an obstacle, as it does not receive it.
bool ProcessLoop::is_obstacle() const {
  return std::ranges::any_of(local_.robots, [this](const LocalRobot& robot) {
    return whereabouts_.is_obstacle(robot.loop.id());
  });
}

/// Whether planner and launcher are there as the mission demands; otherwise robots hold.
bool ProcessLoop::leads(SteadyTime now) const {
  const bool holds = mission_.launcher.on_launcher_loss == LauncherLoss::kHold &&
                     whereabouts_.is_launcher_lost(now);
  return !holds && inbox_.mission().planner_alive(now);
}

/// Receives, steps the robots, then publishes: within a tick no robot sees the new state of
/// another, as in separate processes.
void ProcessLoop::tick(const Time& time) {
  receive(time);
  follow_scene(time);
  find_silent(time.now);
  const std::optional<PlanTime> plan_time = inbox_.plan_time(time.now);
  plans_.receive(inbox_.take_plan(), time.now);
  const std::optional<TakenPlan> new_plan = plans_.take(time.now, plan_time.has_value());

  step_robots({.now = time.now,
               .utc_now = time.utc_now,
               .lateness = time.lateness,
               .period = period_,
               .phase = inbox_.mission().phase(),
               .planner_alive = leads(time.now),
               .may_move = may_move(time.now, time.utc_now),
               .stop_sent = UtcTime(Duration(inbox_.stop_stamp_utc_ns())),
               .plan_version = inbox_.plan_version(),
               .plan_time = plan_time,
               .planned_density = planned_density(plan_time),
               .silent = &silent_},
              new_plan);
  // Cell topics are joined only after the plan: discovery of all endpoints at once takes several
  // times as long, and no robot moves without a plan. One that was restarted in flight has
  // others around it at once.
  if (inbox_.plan_version() > 0 || local_.any_is_underway) {
    bus_.states->publish_everywhere(whereabouts_.had_gap(kDiscoveryLag, time.now));
    bus_.states->publish(published_);
    bus_.states->listen_around(positions_m_);
  }
  confirm_stop();
  status_.on_tick(source(time));
  events_.on_launcher(time.utc_now, whereabouts_.is_launcher_lost(time.now));
  events_.on_tick(time.now, time.utc_now, inbox_, state_age_);
}

/// Robots share the received data, but each has its own driver, random numbers and log.
void ProcessLoop::step_robots(RobotTick tick, const std::optional<TakenPlan>& new_plan) {
  published_.clear();
  positions_m_.clear();
  for (LocalRobot& robot : local_.robots) {
    std::optional<OfferedPlan> offered;
    if (new_plan) {
      const NewPlan& plan = new_plan->plan;
      offered.emplace(OfferedPlan{plan.flow, plan.entry_of(robot.loop.id()), new_plan->again});
    }
    tick.new_plan = offered ? &*offered : nullptr;
    RobotBus bus{inbox_.received(), robot.loop.id(), robot.echo, published_};
    robot.loop.step(
        tick,
        {.driver = *robot.driver, .rng = robot.rng, .log = robot.log, .state_ages = &state_age_},
        bus);
    positions_m_.push_back(robot.loop.position_m());
  }
}

/// Answers those who have sent a stop, once all robots of the process have stopped.
void ProcessLoop::confirm_stop() {
  if (!bus_.stops || inbox_.mission().phase() != MissionPhase::kStopped) return;
  const auto has_stopped = [](const LocalRobot& robot) {
    return robot.loop.mode() == RobotMode::kStopped;
  };
  if (!std::ranges::all_of(local_.robots, has_stopped)) return;
  bus_.stops->confirm({.first = local_.robots.front().loop.id().value(),
                       .count = static_cast<std::uint32_t>(local_.robots.size())});
}

/// Rebuilds the map when the scene has changed, and at every tick while an obstacle moves.
void ProcessLoop::follow_scene(const Time& time) {
  if (auto received = inbox_.take_scene()) {
    scene_ = std::move(*received);
    whereabouts_.on_scene(scene_);
    plans_.on_scene(time.now);
    world_moves_ = true;
    local_.robots.front().log.append(
        robot_log::Note{.stamp = time.utc_now,
                        .caused = UtcTime(Duration(static_cast<std::int64_t>(scene_.version))),
                        .code = "scene",
                        .text = fmt::format("took scene version {}", scene_.version)});
  }
  if (!world_moves_) return;
  // A respawned robot is inside the obstacle of its own body until the launcher receives it
  // and clears that body.
  const auto count = static_cast<std::uint32_t>(local_.robots.size());
  const Scene without_own = without_bodies_of(scene_, local_.robots.front().loop.id(), count);
  *world_ = world_at(mission_.world, without_own, time.utc_now);
  world_moves_ = scene_.moves(time.utc_now);
}

/// The planned density at the plan's time, if the control method reads it; otherwise null.
const PlannedDensity* ProcessLoop::planned_density(const std::optional<PlanTime>& plan_time) {
  if (!density_.is_asked_for() || plans_.newest().empty() || !plan_time) return nullptr;
  density_.update(plans_.newest(), plan_time->plan_time_s);
  return density_.density();
}

void ProcessLoop::end(const Time& time) {
  // The last counters and status go out before drivers are shut down.
  events_.record_link_stats(time.utc_now, inbox_, state_age_);
  status_.publish_all(source(time));
  for (LocalRobot& robot : local_.robots) {
    robot.driver->stop(time.now, StopKind::kHold);
    robot.driver->shutdown();
    robot.log.append(
        robot_log::Note{.stamp = time.utc_now, .code = "exit", .text = "graceful end"});
    robot.log.flush();
  }
}

}  // namespace swarm::agent
