// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_sim/simulate.hpp"

#include <chrono>
#include <cstdio>
#include <fstream>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "swarm_core/app/run_dir.hpp"
#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_core/mission_file/scene_log.hpp"
#include "swarm_core/plan/plan_json.hpp"
#include "swarm_core/plan/planning_record.hpp"
#include "swarm_launcher/processes/builtin_catalogue.hpp"
#include "swarm_launcher/supervision/event_log.hpp"
#include "swarm_launcher/supervision/progress.hpp"
#include "swarm_launcher/supervision/summary.hpp"
#include "swarm_sim/simulation.hpp"
#include "swarmflow/mission/mission_file.hpp"
#include "swarmflow/robot/driver_registry.hpp"

namespace swarm::launcher {
namespace {

/// Writes events, plans, plan clock and scenes into the run directory, in the files of a real run.
class DirectoryObserver final : public SimulationObserver {
 public:
  explicit DirectoryObserver(std::filesystem::path dir)
      : dir_(std::move(dir)),
        events_(append_to_file(dir_ / shell::kEventsFile)),
        scenes_(dir_ / shell::kSceneFile, std::ios::app),
        clock_(dir_ / shell::kPlanClockFile, std::ios::app) {}

  void on_event(UtcTime at, const std::string& source, bool warning, const std::string& code,
                const std::string& text) override {
    events_.write(at, source, warning ? link::Severity::kWarning : link::Severity::kInfo, code,
                  text);
  }

  void on_plan(std::uint32_t version, const planner::PlanResult& planned) override {
    const auto name = version == 1 ? std::filesystem::path(shell::kPlanFile)
                                   : std::filesystem::path(fmt::format("plan-{:04}.json", version));
    if (auto w = shell::write_file(dir_ / name, to_json(planned.plan, planned.excess.by_m));
        !w && !failure_) {
      failure_ = w.error();
    }
  }

  void on_clock(const PlanClock& reading) override {
    clock_ << plan_clock_line(reading) << std::flush;
  }

  void on_scene(const Scene& scene, const SceneChange& change) override {
    scenes_ << scene_log_line(scene.version, change) << std::flush;
  }

  /// The first file that could not be written.
  std::optional<Error> failure() const {
    if (failure_) return failure_;
    for (const auto& [file, is_good] :
         {std::pair{shell::kSceneFile, scenes_.good()}, {shell::kPlanClockFile, clock_.good()}}) {
      if (is_good) continue;
      return Error{ErrorCode::kEnvironment,
                   fmt::format("{} cannot be written", (dir_ / file).string())};
    }
    return std::nullopt;
  }

 private:
  std::filesystem::path dir_;
  EventLog events_;
  std::ofstream scenes_;
  std::ofstream clock_;
  std::optional<Error> failure_;
};

/// Runs a simulation to its end. Shows progress four times a second of wall time, and passes stop
/// signals on: the first ends the mission in order, as in a real run.
void fly(Simulation& simulation, std::uint32_t robots) {
  Progress progress;
  SteadyTime shown_at;
  int interrupts_seen = 0;
  while (simulation.step()) {
    for (; interrupts_seen < shell::stop_requests(); ++interrupts_seen) simulation.interrupt();
    const SteadyTime now = std::chrono::steady_clock::now();
    if (now - shown_at < std::chrono::milliseconds(250)) continue;
    shown_at = now;
    const Supervisor::Counts c = simulation.counts();
    progress.show("simulating", fmt::format("t {:.0f} s  arrived {}/{}", simulation.mission_s(),
                                            c.arrived, robots));
  }
}

/// The summary of a run without logs: no audit, so only arrivals and times.
Result<ExitCode> summarise_unrecorded(const Simulation& simulation, const Measurements& measured,
                                      bool json) {
  const Supervisor::Counts c = simulation.counts();
  const nlohmann::ordered_json summary = {
      {"outcome", to_string(measured.outcome)},
      {"arrived", c.arrived},
      {"mission_s", simulation.mission_s()},
      {"plan_ms", simulation.cost().plan_ms},
      {"wall_s", *measured.wall_s},
      {"ns_per_agent_step", *measured.ns_per_agent_step},
  };
  if (json) {
    std::printf("%s\n", summary.dump(2).c_str());
  } else {
    const std::string text = fmt::format(
        "mission          {}\narrived          {}\nmission time     {:.1f} s\n"
        "wall time        {:.2f} s, {:.0f} ns per agent and step\n",
        to_string(measured.outcome), c.arrived, simulation.mission_s(), *measured.wall_s,
        *measured.ns_per_agent_step);
    std::fputs(text.c_str(), stdout);
  }
  return measured.outcome == Outcome::kCompleted ? ExitCode::kOk : ExitCode::kCriteriaNotMet;
}

/// Ids can be checked only once the number of robots is known.
Result<void> check_kills(const SimulateOptions& options, const Mission& mission) {
  for (const Kill& kill : options.kills) {
    for (const RobotId robot : kill.robots) {
      if (robot.value() < mission.robots.count) continue;
      return fail(ErrorCode::kBadInput,
                  fmt::format("--kill: there is no robot {}, the mission has 0 to {}",
                              robot.value(), mission.robots.count - 1));
    }
  }
  return {};
}

/// A simulation moves the built-in bodies alone.
Result<void> check_bodies(const RobotsSpec& robots) {
  agent::DriverRegistry bodies;
  agent::register_builtin_drivers(bodies);
  for (std::uint32_t i = 0; i < robots.count; ++i) {
    const std::string& model = body_of(robots, RobotId(i)).model;
    if (bodies.find(model) != nullptr) continue;
    return fail(ErrorCode::kBadInput,
                fmt::format("robots.model is \"{}\", a driver of real robots; a simulation moves "
                            "single_integrator, double_integrator and unicycle",
                            model));
  }
  return {};
}

}  // namespace

Result<ExitCode> simulate_mission(const SimulateOptions& options) {
  auto mission = load_mission(options.mission_file, builtin_catalogue(), options.robots);
  if (!mission) return tl::unexpected(mission.error());
  if (auto known = check_kills(options, *mission); !known) return tl::unexpected(known.error());
  if (auto known = check_bodies(mission->robots); !known) return tl::unexpected(known.error());

  std::filesystem::path dir;
  std::unique_ptr<SimulationObserver> observer = std::make_unique<SimulationObserver>();
  const DirectoryObserver* written = nullptr;
  if (options.record) {
    const auto made = shell::make_run_dir(options.out, mission->name);
    if (!made) return tl::unexpected(made.error());
    dir = *made;
    std::fprintf(stderr, "run directory: %s\n", dir.c_str());
    if (auto w = shell::write_file(dir / shell::kMissionFile, to_yaml(*mission)); !w) {
      return tl::unexpected(w.error());
    }
    if (auto w = shell::write_run_info(dir, {.seed = options.seed}); !w) {
      return tl::unexpected(w.error());
    }
    auto to_directory = std::make_unique<DirectoryObserver>(dir);
    written = to_directory.get();
    observer = std::move(to_directory);
  }

  const auto begin = std::chrono::steady_clock::now();
  // Without a record only the first period and the last one are kept.
  Recording recording(*mission, Simulation::begin_utc(),
                      options.record ? 1 : Recording::kFirstAndLast);
  const SimulationOptions simulated{
      .seed = options.seed,
      .faults = options.faults,
      .clocks_in_step = options.clocks_in_step,
      .threads = options.threads > 0 ? options.threads : useful_threads(mission->robots.count),
      .kills = options.kills};
  auto simulation = Simulation::make(*mission, simulated, recording, *observer);
  if (!simulation) return tl::unexpected(simulation.error());
  if (options.record) {
    // The audit compares densities with the cap that the planner guarantees.
    const PlanningRecord promised{mission->planner.method,
                                  (*simulation)->planning_method().traits().density_cap_per_m2};
    if (auto w = shell::write_file(dir / shell::kPlanningFile, to_json(promised)); !w) {
      return tl::unexpected(w.error());
    }
  }
  fly(**simulation, mission->robots.count);
  const Simulation::Cost cost = (*simulation)->cost();
  Measurements measured{.outcome = (*simulation)->outcome(),
                        .channel = std::nullopt,
                        .plan_ms = cost.plan_ms,
                        .wall_s = to_seconds(std::chrono::steady_clock::now() - begin),
                        .ns_per_agent_step = cost.median_step_ns};
  if (!options.record) return summarise_unrecorded(**simulation, measured, options.json);
  // A file that could not be written ends the run only here, after the simulation.
  if (const auto failure = written->failure()) return tl::unexpected(*failure);
  if (auto w = recording.write(dir); !w) return tl::unexpected(w.error());
  shell::release_stop_signals();  // an audit may take long
  return summarise(dir, measured, options.json);
}

}  // namespace swarm::launcher
