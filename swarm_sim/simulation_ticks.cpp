// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The ticks of a simulation's robots, and what they publish.
#include <optional>

#include "swarm_core/base/prefetch.hpp"
#include "swarm_sim/simulation.hpp"

namespace swarm::launcher {
namespace {

// Periods between two measurements of state ages, per robot: a histogram costs time at every state.
constexpr std::uint64_t kPeriodsPerAges = 10;
// This many robots, with what they point to, stay in a core's cache from tick to tick.
constexpr std::size_t kFitInCache = 200;

}  // namespace

/// The simulated network as one robot sees it.
struct Simulation::RobotBus {
  const SimulatedNetwork& network;
  Robot& robot;
  SteadyTime now;
  const Robot* prefetched;  // a later robot, fetched while this one decides; null: none
  std::vector<link::RobotStateMessage>& published;

  template <class Take>
  void receive(const Vec2& position_m, Take take) {
    network.receive(
        robot.loop.id(), position_m, robot.communication_radius_m, robot.received_until, now,
        [&](const agent::NeighbourReport& report) { take(report, now - report.as_of); });
    robot.received_until = now;
    if (prefetched != nullptr) prefetch(*prefetched);
  }
  void publish(const link::RobotStateMessage& state) { published.push_back(state); }
};

// A swarm is larger than the cache: a robot is prefetched two robots ahead, its neighbour table one
// robot ahead. Spread over the tick, as the processor has a limited number of memory requests open.
void Simulation::prefetch(const Robot& robot) {
  robot.loop.prefetch();
  swarm::prefetch(&robot.body, sizeof(Robot) - sizeof(robot.loop));
}

/// What all robots that tick at this moment have in common.
agent::RobotTick Simulation::tick_at(SteadyTime now) const {
  return {.now = now,
          .utc_now = utc(now),
          .period = period_,
          .phase = phase_,
          .planner_alive = true,
          .stop_sent = stop_sent_,
          .plan_version = clock_.plan_version,
          .plan_time = plan_time(now),
          .planned_density = density_.density()};
}

/// The newest plan for a robot that does not follow it yet, or is to look at its path again.
std::optional<agent::OfferedPlan> Simulation::offered_plan(const Robot& robot) const {
  const bool follows = robot.plan_version == keeper_.version();
  if (follows && !robot.repeats_plan) return std::nullopt;
  const planner::Replan& newest = keeper_.newest();
  agent::OfferedPlan offered{.flow = newest.planned.plan, .again = follows};
  const std::uint32_t id = robot.loop.id().value();
  if (id < newest.entries.size() && newest.entries[id].source != planner::PlanEntry::kAnywhere) {
    offered.entry = {newest.entries[id].source, newest.entries[id].share / 65536.0};
  }
  return offered;
}

/// One tick of one robot, by the loop of a real process.
[[gnu::hot]] void Simulation::tick_robot(std::uint32_t id, const agent::RobotTick& tick,
                                         const Upcoming& upcoming, Collected& collected) {
  Robot& robot = robots_[id];
  if (upcoming.next != nullptr) upcoming.next->loop.prefetch_neighbours();
  RobotRecording log(recording_, RobotId(id));
  const bool measures_ages = (periods_ + id) % kPeriodsPerAges == 0;
  const agent::RobotParts parts{.driver = robot.body,
                                .rng = rngs_[id],
                                .log = log,
                                .state_ages = measures_ages ? &collected.ages : nullptr};
  RobotBus bus{network_, robot, tick.now, upcoming.second, collected.published};
  if (const auto offered = offered_plan(robot)) {
    agent::RobotTick with_plan = tick;
    with_plan.new_plan = &*offered;
    robot.loop.step(with_plan, parts, bus);
    robot.plan_version = keeper_.version();
    robot.repeats_plan = false;
  } else {
    robot.loop.step(tick, parts, bus);
  }
  if (robot.loop.has_updates()) has_updates_[id] = 1;
}

/// Ticks the robots of a slot in parallel, each thread a contiguous part of them. States are sent
/// only when all have ticked, in the order of the robots: threads do not change the result.
void Simulation::tick_slot(std::size_t slot) {
  const std::vector<std::uint32_t>& members = slots_[slot];
  const agent::RobotTick tick = tick_at(now_ + period_ * static_cast<std::int64_t>(slot) /
                                                   static_cast<std::int64_t>(slots_.size()));
  const std::size_t parts = thread_pool_.size();
  const bool prefetches = robots_.size() > kFitInCache;
  thread_pool_.run([&](std::size_t part) {
    const std::size_t first = members.size() * part / parts;
    const std::size_t last = members.size() * (part + 1) / parts;
    for (std::size_t i = first; i < last; ++i) {
      const bool has_next = prefetches && i + 1 < last;
      const bool has_second = prefetches && i + 2 < last;
      const Upcoming upcoming{.next = has_next ? &robots_[members[i + 1]] : nullptr,
                              .second = has_second ? &robots_[members[i + 2]] : nullptr};
      tick_robot(members[i], tick, upcoming, collected_[part]);
    }
  });
  deliver_published(tick.now);
}

/// Sends the published states by the network. Each state is checked once here, instead of by each
/// of its receivers; the result is the same.
[[gnu::hot]] void Simulation::deliver_published(SteadyTime now) {
  sent_states_.clear();
  for (Collected& collected : collected_) {
    for (const link::RobotStateMessage& state : collected.published) {
      if (!gate_.state(state, utc(now))) continue;
      sent_states_.push_back({.robot = RobotId(state.robot_id),
                              .sequence = state.sequence_number,
                              .as_of = now,
                              .position_m = {state.x_m, state.y_m},
                              .velocity_mps = {state.vx_mps, state.vy_mps}});
    }
    collected.published.clear();
  }
  network_.post(now, sent_states_);
}

/// Passes the status of robots to supervisor and planner, without delay: robots in turn, and those
/// with updates.
void Simulation::report_status() {
  std::uint64_t in_turn = cadence_.first_in_turn(periods_);
  for (std::uint32_t i = 0; i < robots_.size(); ++i) {
    const bool is_in_turn = i == in_turn;
    if (is_in_turn) in_turn += cadence_.every();
    if (!is_in_turn && has_updates_[i] == 0) continue;
    has_updates_[i] = 0;
    if (dead_[i] != 0) continue;
    const link::RobotStatusMessage status = robots_[i].loop.status();
    supervisor_.on_status(RobotId(i), {.has_plan = robots_[i].loop.has_route(),
                                       .receives_neighbours = true,
                                       .mode = status.mode,
                                       .settled = status.settled,
                                       .scene_version = keeper_.planned_scene(),
                                       .sent_at = now_,
                                       .confirms_stop = phase_ == MissionPhase::kStopped &&
                                                        status.mode == RobotMode::kStopped});
    keeper_.receive({.robot = RobotId(i),
                     .position_m = {status.x_m, status.y_m},
                     .arrived = status.arrived,
                     .lag_s = status.lag_s,
                     .plan_version = keeper_.version(),
                     .plan_time_s = clock_.plan_time_s},
                    status.mode == RobotMode::kMoving, now_);
  }
}

/// Adds a robot's counters to the recording, at the end of the mission or of its process.
void Simulation::count_states(const Robot& robot) {
  recording_.link().states_sent += robot.loop.states_sent();
  recording_.link().states_received += robot.loop.states_received();
}

}  // namespace swarm::launcher
