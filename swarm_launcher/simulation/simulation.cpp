// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/simulation/simulation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "planner_service/methods/builtin_methods.hpp"
#include "robot_agent/control/density_attraction.hpp"
#include "swarm_core/mission/placement.hpp"

namespace swarm::launcher {
namespace {

// Where a robot's clock stands matters only relative to others'.
constexpr SteadyTime kBegin{std::chrono::seconds(1000)};
// Of a control period, with clocks out of step.
constexpr std::size_t kSlots = 10;
// Below, waking a second thread twice a period costs more than it brings.
constexpr std::uint32_t kRobotsPerThread = 400;
// A robot's states' ages are looked at in every so manieth period.
constexpr std::uint64_t kAgesEvery = 10;

double hears_m(const Mission& mission, RobotId robot) {
  const double own_m = body_of(mission.robots, robot).hear_radius_m;
  return own_m > 0.0 ? own_m : mission.link.hear_radius_m;
}

/// Each robot has a process that may die, and all of them start at once.
SupervisorOptions supervisor_options(const Mission& mission) {
  LauncherSpec launcher = mission.launcher;
  launcher.starts_per_s = 1e9;
  launcher.starting_max = mission.robots.count;
  return {.robots = mission.robots.count,
          .per_process = 1,
          .launcher = launcher,
          .script = mission.script};
}

std::vector<Kill> in_order_of_time(std::vector<Kill> kills) {
  std::stable_sort(kills.begin(), kills.end(),
                   [](const Kill& a, const Kill& b) { return a.at_s < b.at_s; });
  return kills;
}

}  // namespace

Simulation::Simulation(const Mission& mission, planner::Planner planner,
                       const SimulationOptions& options, Recording& recording,
                       SimulationObserver& observer)
    : mission_(mission),
      options_(options),
      recording_(recording),
      observer_(observer),
      period_(from_seconds(1.0 / mission.control.rate_hz)),
      world_(mission.world),
      scene_(first_scene(mission.world.obstacles().size())),
      keeper_(mission, std::move(planner), options.seed, &std::chrono::steady_clock::now),
      supervisor_(supervisor_options(mission), kBegin),
      air_(mission.world.bounds_m(), hears_farthest_m(mission), options.faults,
           mix_seed(options.seed, 0xA1B), kBegin),
      crew_(std::max<std::size_t>(options.threads, 1)),
      collected_(crew_.size()),
      now_(kBegin) {
  options_.kills = in_order_of_time(std::move(options_.kills));
}

Result<std::unique_ptr<Simulation>> Simulation::make(const Mission& mission,
                                                     const SimulationOptions& options,
                                                     Recording& recording,
                                                     SimulationObserver& observer) {
  const auto positions_m = place_robots(mission, options.seed);
  if (!positions_m) return tl::unexpected(positions_m.error());
  planner::PlanningRegistry methods;
  planner::register_builtin_methods(methods);
  auto planner = planner::Planner::make(methods, mission);
  if (!planner) return tl::unexpected(planner.error());
  std::unique_ptr<Simulation> made(
      new Simulation(mission, *std::move(planner), options, recording, observer));
  if (auto planned = made->keeper_.plan_first(); !planned) return tl::unexpected(planned.error());
  made->keeper_.begin(kBegin);
  made->keeper_.take_scene(made->scene_);
  made->place(*positions_m);
  return made;
}

std::size_t useful_threads(std::uint32_t robots) {
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  return std::clamp<std::size_t>(robots / kRobotsPerThread, 1, cores);
}

UtcTime Simulation::begin_utc() { return std::chrono::sys_days{std::chrono::year{2026} / 1 / 1}; }

UtcTime Simulation::utc(SteadyTime t) const { return begin_utc() + (t - kBegin); }

void Simulation::place(const std::vector<Vec2>& positions_m) {
  robots_.reserve(positions_m.size());
  rngs_.reserve(positions_m.size());
  has_news_.resize(positions_m.size());
  dead_.resize(positions_m.size());
  agent::AgentOptionsOf options_of(mission_);
  slots_.resize(options_.clocks_in_step ? 1 : kSlots);
  for (std::uint32_t i = 0; i < positions_m.size(); ++i) {
    const RobotId id(i);
    rngs_.push_back(agent::agent_rng(id, options_.seed));
    robots_.push_back(
        {.agent = {world_, options_of(id), agent::agent_identity(mission_, id)},
         .body = agent::make_simulated_body(body_of(mission_.robots, id), kBegin, positions_m[i],
                                            mix_seed(mix_seed(options_.seed, 0xB0D), i)),
         .hears_m = hears_m(mission_, id),
         .heard_until = kBegin,
         .position_m = positions_m[i]});
    slots_[slot_of(i)].push_back(i);
  }
}

/// As processes do: multiples of the golden ratio spread any number of them evenly.
std::size_t Simulation::slot_of(std::uint32_t robot) const {
  const double turn = robot * (std::numbers::phi - 1.0);
  const auto slot =
      static_cast<std::size_t>((turn - std::floor(turn)) * static_cast<double>(slots_.size()));
  return std::min(slot, slots_.size() - 1);
}

void Simulation::publish() {
  const planner::Replan& newest = keeper_.newest();
  plan_ms_ += newest.planned.stats.total_ms;
  observer_.on_plan(keeper_.version(), newest.planned);
  const std::string text = fmt::format("took plan version {}", keeper_.version());
  crew_.run([&](std::size_t part) {
    for (std::size_t i = part; i < robots_.size(); i += crew_.size()) {
      if (dead_[i] != 0) continue;
      std::optional<agent::PlanEntry> entry;
      if (i < newest.entries.size() && newest.entries[i].source != planner::PlanEntry::kAnywhere) {
        entry = {newest.entries[i].source, newest.entries[i].share / 65536.0};
      }
      robots_[i].agent.accept_plan(newest.planned.plan, robots_[i].position_m, entry);
      recording_.note(RobotId(static_cast<std::uint32_t>(i)), utc(now_), "plan", text);
    }
  });
}

void Simulation::keep_planned() {
  const planner::PlanKeeper::Step step = keeper_.step(now_, utc(now_));
  for (const planner::PlanKeeper::Notice& notice : step.notices) {
    observer_.on_event(utc(now_), "planner", notice.warning, notice.code, notice.text);
  }
  if (step.publish) publish();
  clock_ = keeper_.clock(utc(now_));
  if (step.clock) observer_.on_clock(*step.clock);
  if (mission_.control.density_push_mps > 0.0 && clock_.plan_version > 0) {
    agent::update(planned_density_, keeper_.newest().planned.plan, clock_.plan_time_s,
                  mission_.robots.count, agent::DensityAttractionOptions{}.kernel_sigma_m());
  }
}

/// Every robot has the clock from the planner's heartbeats, which take no time here.
std::optional<agent::PlanTime> Simulation::plan_time(SteadyTime now) const {
  if (clock_.plan_version == 0) return std::nullopt;
  return agent::PlanTime{clock_.plan_time_s + clock_.rate * to_seconds(now - now_), clock_.rate};
}

void Simulation::change_scene(std::span<const SceneChange> changes) {
  for (const SceneChange& change : changes) {
    auto next = after(scene_, change, mission_.world, utc(now_));
    if (!next) {
      observer_.on_event(utc(now_), "launcher", true, "scene-refused", next.error().message);
      continue;
    }
    scene_ = *std::move(next);
    observer_.on_scene(scene_, change);
    if (std::holds_alternative<GoTo>(change)) supervisor_.on_new_goal(scene_.version);
  }
  keeper_.take_scene(scene_);
  world_moves_ = true;
}

void Simulation::act(const Action& action) {
  if (const auto* command = std::get_if<SendCommand>(&action)) {
    phase_ = command->kind == CommandKind::kStop ? MissionPhase::kStopped
                                                 : phase_after(phase_, command->kind);
    keeper_.set_phase(phase_);
  } else if (const auto* scene = std::get_if<ChangeScene>(&action)) {
    change_scene({&scene->change, 1});
  } else if (const auto* start = std::get_if<StartProcess>(&action)) {
    if (start->process != kPlanner) respawn(supervisor_.robots_of(start->process).first);
  } else if (const auto* fallen = std::get_if<AddBodies>(&action)) {
    add_bodies(fallen->robots);
  } else if (const auto* risen = std::get_if<ClearBodies>(&action)) {
    clear_bodies(risen->robots);
  } else if (const auto* signal = std::get_if<SignalProcess>(&action)) {
    supervisor_.on_exit(signal->process, {}, now_);
  } else if (const auto* event = std::get_if<LogEvent>(&action)) {
    observer_.on_event(utc(now_), "launcher", event->warning, event->code, event->text);
  }
}

void Simulation::supervise() {
  for (const Action& action : supervisor_.step(now_)) act(action);
}

/// Once a second and at every change of mode, as over the bus.
void Simulation::report_status() {
  const auto every = std::max<std::uint64_t>(
      1,
      static_cast<std::uint64_t>(std::llround(mission_.control.rate_hz / mission_.link.status_hz)));
  std::uint64_t in_turn = (every - periods_ % every) % every;
  for (std::uint32_t i = 0; i < robots_.size(); ++i) {
    const bool is_in_turn = i == in_turn;
    if (is_in_turn) in_turn += every;
    if (!is_in_turn && has_news_[i] == 0) continue;
    has_news_[i] = 0;
    if (dead_[i] != 0) continue;
    const Robot& robot = robots_[i];
    supervisor_.on_status(RobotId(i), {.has_plan = robot.agent.has_route(),
                                       .hears_neighbours = true,
                                       .mode = robot.mode,
                                       .settled = robot.settled,
                                       .scene_version = keeper_.planned_scene(),
                                       .sent_at = now_});
    keeper_.hear({.robot = RobotId(i),
                  .position_m = robot.position_m,
                  .arrived = robot.mode == RobotMode::kArrived,
                  .lag_s = robot.agent.lag_s(),
                  .plan_version = keeper_.version(),
                  .plan_time_s = clock_.plan_time_s},
                 robot.mode == RobotMode::kMoving, now_);
  }
}

void Simulation::tick_robot(std::uint32_t id, SteadyTime now, const Upcoming& upcoming,
                            Collected& collected) {
  const bool looks_at_ages = (periods_ + id) % kAgesEvery == 0;
  Robot& robot = robots_[id];
  if (upcoming.next != nullptr) upcoming.next->agent.prefetch_neighbours();
  const agent::Measurement body = robot.body.measure(now);
  robot.position_m = body.position_m;
  air_.hear(RobotId(id), robot.position_m, robot.hears_m, robot.heard_until, now,
            [&](const agent::NeighbourReport& report) {
              const Duration late = now - report.as_of;
              robot.agent.hear(report, robot.position_m, late);
              ++robot.received;
              if (looks_at_ages) collected.ages.add(late / std::chrono::microseconds(1));
            });
  robot.heard_until = now;
  if (upcoming.second != nullptr) prefetch(*upcoming.second);
  const RobotMode before = robot.mode;
  const agent::AgentOutput out = robot.agent.tick(
      {.now = now,
       .position_m = robot.position_m,
       .phase = phase_,
       .planner_alive = true,
       .velocity_mps = body.velocity_mps,
       .plan_time = plan_time(now),
       .planned_density = planned_density_.parts.empty() ? nullptr : &planned_density_},
      rngs_[id]);
  robot.mode = out.mode;
  robot.settled = out.settled;
  robot.body.command(now, out.velocity_mps, 2 * period_);

  const RobotId robot_id(id);
  const UtcTime stamp = utc(now);
  if (out.say) {
    collected.said.push_back({.robot = robot_id,
                              .sequence = ++robot.sequence,
                              .as_of = now,
                              .position_m = robot.position_m,
                              .velocity_mps = out.told_mps});
  }
  if (out.mode != before || out.settled) has_news_[id] = 1;
  if (out.mode != before)
    recording_.note(robot_id, stamp, "mode", std::string(to_string(out.mode)));
  const agent::TimeTracking tracking = out.tracking.value_or(agent::TimeTracking{});
  recording_.step(robot_id,
                  {.stamp = stamp,
                   .position_m = body.true_position_m.value_or(body.position_m),
                   .velocity_mps = out.velocity_mps,
                   .mode = static_cast<std::uint8_t>(out.mode),
                   .goal = robot.agent.has_route() ? static_cast<std::uint8_t>(std::min(
                                                         robot.agent.goal(robot.position_m), 254U))
                                                   : blackbox::Step::kNoGoal,
                   .neighbours = out.neighbours,
                   .plan_version = out.tracking ? clock_.plan_version : 0,
                   .plan_time_s = static_cast<float>(tracking.plan_time_s),
                   .reference_x_m = static_cast<float>(tracking.reference_m.x()),
                   .reference_y_m = static_cast<float>(tracking.reference_m.y())});
}

// A swarm is larger than the cache: a robot is fetched two robots ahead, the neighbours it knows
// one robot ahead, a part at a time, for the memory takes only so many orders at once.
void Simulation::prefetch(const Robot& robot) const {
  robot.agent.prefetch();
  swarm::prefetch(&robot.body, sizeof(Robot) - sizeof(robot.agent));
}

void Simulation::tick_slot(std::size_t slot) {
  const std::vector<std::uint32_t>& members = slots_[slot];
  const SteadyTime now =
      now_ + period_ * static_cast<std::int64_t>(slot) / static_cast<std::int64_t>(slots_.size());
  const std::size_t parts = crew_.size();
  crew_.run([&](std::size_t part) {
    const std::size_t first = members.size() * part / parts;
    const std::size_t last = members.size() * (part + 1) / parts;
    for (std::size_t i = first; i < last; ++i) {
      const Upcoming upcoming{.next = i + 1 < last ? &robots_[members[i + 1]] : nullptr,
                              .second = i + 2 < last ? &robots_[members[i + 2]] : nullptr};
      tick_robot(members[i], now, upcoming, collected_[part]);
    }
  });
  std::vector<agent::NeighbourReport>& said = collected_.front().said;
  for (std::size_t part = 1; part < parts; ++part) {
    std::vector<agent::NeighbourReport>& more = collected_[part].said;
    said.insert(said.end(), more.begin(), more.end());
    more.clear();
  }
  air_.post(now, said);
  said.clear();
}

bool Simulation::step() {
  kill_due();
  supervise();
  if (supervisor_.stage() == Supervisor::Stage::kDone) {
    for (std::uint32_t i = 0; i < robots_.size(); ++i) {
      if (dead_[i] == 0) recording_.note(RobotId(i), utc(now_), "exit", "graceful end");
      recording_.link().states_sent += robots_[i].sequence;
      recording_.link().states_received += robots_[i].received;
    }
    for (const Collected& c : collected_) recording_.link().state_age.merge(c.ages);
    return false;
  }
  if (world_moves_) {
    world_ = world_at(mission_.world, scene_, utc(now_));
    world_moves_ = scene_.moves(utc(now_));
  }
  keep_planned();  // robots make their paths on the new map
  recording_.begin_period();
  coast_fallen();
  const auto begin = std::chrono::steady_clock::now();
  for (std::size_t slot = 0; slot < slots_.size(); ++slot) tick_slot(slot);
  const double took_s = to_seconds(std::chrono::steady_clock::now() - begin);
  agents_s_ += took_s;
  step_ns_.push_back(static_cast<float>(1e9 * took_s / static_cast<double>(robots_.size())));
  admit_respawned();
  report_status();
  ++periods_;
  now_ += period_;
  air_.forget(now_ - period_);
  return true;
}

Simulation::Cost Simulation::cost() const {
  Cost cost{.plan_ms = plan_ms_,
            .agent_steps = periods_ * robots_.size(),
            .agents_s = agents_s_,
            .median_step_ns = 0.0};
  if (step_ns_.empty()) return cost;
  std::vector<float> sorted = step_ns_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  cost.median_step_ns = static_cast<double>(*middle);
  return cost;
}

}  // namespace swarm::launcher
