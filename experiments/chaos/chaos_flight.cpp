// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/chaos_flight.hpp"

#include <chrono>
#include <csignal>
#include <fstream>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "experiments/chaos/flight_processes.hpp"
#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_launcher/processes/child_process.hpp"

namespace swarm::launcher {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(20);
constexpr Duration kLongest = std::chrono::minutes(10);

SteadyTime now() { return std::chrono::steady_clock::now(); }

class ChaosFlight {
 public:
  ChaosFlight(const ChaosFlightSpec& spec, pid_t launcher)
      : spec_(spec), launcher_(launcher), log_(spec.dir.string() + ".chaos.jsonl") {}

  std::vector<Fault> fly() {
    const SteadyTime begin = now();
    while (!has_ended()) {
      std::this_thread::sleep_for(kStep);
      if (now() - begin > kLongest || shell::stop_requests() > 1) ::kill(launcher_, SIGKILL);
      if (!started_at_ && mission_has_started()) started_at_ = now();
      if (started_at_) play(now() - *started_at_);
    }
    return injected_;
  }

 private:
  bool has_ended() {
    while (const auto child = reap_child()) {
      if (child->pid == launcher_) return true;
    }
    return false;
  }

  bool mission_has_started() const {
    const auto events = shell::read_file(spec_.dir / shell::kEventsFile, 1U << 24U);
    return events && events->find("\"command\"") != std::string::npos;
  }

  /// Injects and undoes what is due.
  void play(Duration mission_time) {
    for (; next_ < spec_.faults.size() && spec_.faults[next_].at <= mission_time; ++next_) {
      const Fault& fault = spec_.faults[next_];
      if (!inject(fault)) continue;
      log(mission_time, fault, "begin");
      injected_.push_back(fault);
      if (fault.lasts > Duration::zero())
        open_.push_back({fault, frozen_, mission_time + fault.lasts});
    }
    std::erase_if(open_, [&](const Open& open) {
      if (mission_time < open.until) return false;
      undo(open);
      log(mission_time, open.fault, "end");
      return true;
    });
  }

  bool inject(const Fault& fault) {
    switch (fault.kind) {
      case FaultKind::kKillAgent:
        return signal(agent_of(launcher_, fault.agent), SIGKILL);
      case FaultKind::kFreezeAgent:
        return signal(agent_of(launcher_, fault.agent), SIGSTOP);
      case FaultKind::kKillPlanner:
        return signal(planner_of(launcher_), SIGKILL);
      case FaultKind::kFreezePlanner:
        return signal(planner_of(launcher_), SIGSTOP);
      case FaultKind::kFreezeLauncher:
        return signal(launcher_, SIGSTOP);
      case FaultKind::kPause:
        return command({"pause"});
      case FaultKind::kAddObstacle: {
        const Vec2 at =
            spec_.bounds_m.min_m + Vec2(fault.x_share, fault.y_share)
                                       .cwiseProduct(spec_.bounds_m.max_m - spec_.bounds_m.min_m);
        return command(
            {"add_obstacle",
             fmt::format("circle_m: {{center: [{:.2f}, {:.2f}], radius: 0.4}}", at.x(), at.y())});
      }
    }
    return false;
  }

  struct Open {
    Fault fault;
    pid_t pid;
    Duration until;
  };

  // An obstacle stays: its id is the launcher's.
  void undo(const Open& open) {
    switch (open.fault.kind) {
      case FaultKind::kFreezeAgent:
      case FaultKind::kFreezePlanner:
      case FaultKind::kFreezeLauncher:
        ::kill(open.pid, SIGCONT);
        break;
      case FaultKind::kPause:
        command({"resume"});
        break;
      default:
        break;
    }
  }

  bool signal(std::optional<pid_t> pid, int number) {
    if (!pid || ::kill(*pid, number) != 0) return false;
    frozen_ = *pid;
    return true;
  }

  // Not waited for: the launcher may be frozen.
  bool command(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(),
                     {sibling_program("swarm_launcher"), "command", spec_.dir.string()});
    return start_process(arguments, spec_.dir.string() + ".commands.log").has_value();
  }

  void log(Duration mission_time, const Fault& fault, const char* edge) {
    log_ << nlohmann::json{{"t_s", to_seconds(mission_time)},
                           {"fault", to_string(fault.kind)},
                           {"edge", edge},
                           {"agent", fault.agent}}
                .dump()
         << std::endl;
  }

  const ChaosFlightSpec& spec_;
  pid_t launcher_;
  std::ofstream log_;
  std::optional<SteadyTime> started_at_{};
  std::size_t next_ = 0;
  pid_t frozen_ = 0;  ///< process of the last signal
  std::vector<Open> open_;
  std::vector<Fault> injected_;
};

}  // namespace

Result<std::vector<Fault>> fly_disturbed(const ChaosFlightSpec& spec) {
  std::vector<std::string> line = {sibling_program("swarm_launcher"),
                                   "run",
                                   spec.mission.string(),
                                   "--out",
                                   spec.dir.string(),
                                   "--robots",
                                   fmt::format("{}", spec.robots),
                                   "--seed",
                                   fmt::format("{}", spec.seed),
                                   "--per-process",
                                   "1",
                                   "--json"};
  if (!spec.network.empty()) line.insert(line.end(), {"--fault", spec.network});
  const auto launcher = start_process(line, spec.dir.string() + ".log");
  if (!launcher) return tl::unexpected(launcher.error());
  return ChaosFlight(spec, *launcher).fly();
}

}  // namespace swarm::launcher
