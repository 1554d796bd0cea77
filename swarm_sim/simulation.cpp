// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_sim/simulation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "planner_service/methods/builtin_methods.hpp"
#include "robot_agent/loop/tick_phase.hpp"
#include "robot_agent/methods/shared/density_attraction.hpp"
#include "swarm_core/mission/placement.hpp"

namespace swarm::launcher {
namespace {

// The steady clock at the start of every simulation: only differences of it matter.
constexpr SteadyTime kBegin{std::chrono::seconds(1000)};
// Moments of a control period at which robots tick, with clocks out of step.
constexpr std::size_t kSlots = 10;
// With fewer robots, waking another thread twice a period costs more than it saves.
constexpr std::uint32_t kRobotsPerThread = 400;
// The planner of a simulation does not die.
constexpr std::uint64_t kPlannerEpoch = 1;

/// A body's own communication radius, or the mission's.
double communication_radius_m(const Mission& mission, RobotId robot) {
  const double own_m = body_of(mission.robots, robot).communication_radius_m;
  return own_m > 0.0 ? own_m : mission.link.communication_radius_m;
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
      cadence_(mission.control.rate_hz, mission.link.status_hz),
      network_(mission.world.bounds_m(), largest_communication_radius_m(mission), options.faults,
               mix_seed(options.seed, 0xA1B), kBegin),
      gate_({.limits = link::wire_limits(mission)}),
      thread_pool_(std::max<std::size_t>(options.threads, 1)),
      collected_(thread_pool_.size()),
      now_(kBegin),
      density_(mission, agent::AgentOptionsOf(mission).reads_density()) {
  options_.kills = in_order_of_time(std::move(options_.kills));
}

/// Plans before the first period; a mission without a plan fails here.
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
  has_updates_.resize(positions_m.size());
  dead_.resize(positions_m.size());
  agent::AgentOptionsOf options_of(mission_);
  slots_.resize(options_.clocks_in_step ? 1 : kSlots);
  for (std::uint32_t i = 0; i < positions_m.size(); ++i) {
    const RobotId id(i);
    rngs_.push_back(agent::agent_rng(id, options_.seed));
    robots_.push_back(
        {.loop = {world_, options_of(id), agent::agent_identity(mission_, id)},
         .body = agent::make_simulated_body(body_of(mission_.robots, id), kBegin, positions_m[i],
                                            agent::body_seed(id, options_.seed)),
         .communication_radius_m = communication_radius_m(mission_, id),
         .received_until = kBegin});
    robots_.back().loop.place_at(positions_m[i]);
    slots_[slot_of(i)].push_back(i);
  }
}

/// The phase of a real process, rounded down to a slot.
std::size_t Simulation::slot_of(std::uint32_t robot) const {
  const double slots = static_cast<double>(slots_.size());
  return std::min(static_cast<std::size_t>(agent::tick_phase(robot) * slots), slots_.size() - 1);
}

/// Records a new plan. Robots accept it when they tick next.
void Simulation::publish() {
  plan_ms_ += keeper_.newest().planned.stats.total_ms;
  observer_.on_plan(keeper_.version(), keeper_.newest().planned);
  repeat_plan_at_.reset();
}

/// No plan could be made for a new scene: see agent::kReplanTimeout.
void Simulation::repeat_plan() {
  for (Robot& robot : robots_) robot.repeats_plan = true;
  repeat_plan_at_.reset();
}

/// One step of the planner: reports its notices, publishes a new plan, and advances the plan's
/// clock and density to now.
void Simulation::keep_planned() {
  const planner::PlanKeeper::Step step = keeper_.step(now_, utc(now_));
  for (const planner::PlanKeeper::Notice& notice : step.notices) {
    observer_.on_event(utc(now_), "planner", notice.warning, notice.code, notice.text);
  }
  if (step.publish) publish();
  if (repeat_plan_at_ && now_ >= *repeat_plan_at_) repeat_plan();
  clock_ = keeper_.clock(utc(now_));
  if (step.clock) observer_.on_clock(*step.clock);
  supervisor_.on_heartbeat(kPlannerEpoch);
  if (density_.is_asked_for() && clock_.plan_version > 0) {
    density_.update(keeper_.newest().planned.plan, clock_.plan_time_s);
  }
}

/// The plan time that every robot knows: in a simulation heartbeats arrive at once.
std::optional<agent::PlanTime> Simulation::plan_time(SteadyTime now) const {
  if (clock_.plan_version == 0) return std::nullopt;
  return agent::PlanTime{clock_.plan_time_s + clock_.rate * to_seconds(now - now_), clock_.rate};
}

/// Applies the changes one by one; one that is not possible is refused, the others count.
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
  repeat_plan_at_ = now_ + agent::kReplanTimeout;
  world_moves_ = true;
}

/// Carries out what the supervisor would have the launcher do. Signalled processes exit at once.
void Simulation::act(const Action& action) {
  if (const auto* command = std::get_if<SendCommand>(&action)) {
    phase_ = command->kind == CommandKind::kStop ? MissionPhase::kStopped
                                                 : phase_after(phase_, command->kind);
    if (command->kind == CommandKind::kStop) stop_sent_ = utc(now_);
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

/// The order of a period: deaths and supervisor, map, planner, robots, status. Robots thus see the
/// scene and the plan of this period, and the supervisor acts on their status in the next.
bool Simulation::step() {
  kill_due();
  supervise();
  if (supervisor_.stage() == Supervisor::Stage::kDone) {
    for (std::uint32_t i = 0; i < robots_.size(); ++i) {
      if (dead_[i] == 0)
        recording_.note(RobotId(i), {.stamp = utc(now_), .code = "exit", .text = "graceful end"});
      count_states(robots_[i]);
    }
    // The end: completes the recording.
    for (const Collected& c : collected_) recording_.link().state_age.merge(c.ages);
    if (const link::RefusalCounters& refused = gate_.refused(); refused.total() > 0) {
      recording_.link().refused.assign(refused.all().begin(), refused.all().end());
    }
    return false;
  }
  if (world_moves_) {
    world_ = world_at(mission_.world, scene_, utc(now_));
    world_moves_ = scene_.moves(utc(now_));
  }
  keep_planned();  // after the map: robots compute their paths on it
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
  network_.forget(now_ - period_);
  return true;
}

/// The median over periods, as single periods include those in which all robots enter a new plan.
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
