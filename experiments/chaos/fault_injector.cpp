// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/fault_injector.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "swarm_core/robot_log/robot_log_file.hpp"
#include "swarm_launcher/processes/child_process.hpp"

namespace swarm::launcher {
namespace {

// Until the scene with a new obstacle has reached the robots, on a loaded machine, and what a robot
// drives meanwhile, with the radius of the obstacle.
constexpr Duration kCommandTime = std::chrono::seconds(3);
constexpr double kAway_m = 6.0;
// Places that are tried for an obstacle. Irrational steps spread them over the map.
constexpr int kPlaces = 16;
constexpr double kNextX = 0.6180339887;
constexpr double kNextY = 0.4142135624;

}  // namespace

bool is_clear_of_robots(const std::filesystem::path& run_dir, const Vec2& at_m, double distance_m) {
  const auto folder = robot_log::file_of(run_dir, RobotId(0)).parent_path();
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    const auto steps = robot_log::last_steps(entry.path());
    if (!steps || steps->empty()) continue;
    if ((steps->back().position_m - at_m).norm() < distance_m) return false;
  }
  return true;
}

FaultInjector::FaultInjector(std::vector<Fault> schedule, FaultTargets targets)
    : schedule_(std::move(schedule)), targets_(std::move(targets)) {}

void FaultInjector::play(Duration mission_time) {
  for (; next_ < schedule_.size() && schedule_[next_].at <= mission_time; ++next_) {
    const Fault& fault = schedule_[next_];
    if (!inject(fault)) continue;
    log(mission_time, fault, "begin");
    injected_.push_back(fault);
    if (fault.lasts > Duration::zero())
      open_.push_back({fault, signalled_, mission_time + fault.lasts});
  }
  std::erase_if(open_, [&](const Open& open) {
    if (mission_time < open.until) return false;
    undo(open);
    log(mission_time, open.fault, "end");
    return true;
  });
}

void FaultInjector::undo_all(Duration mission_time) {
  for (const Open& open : std::exchange(open_, {})) {
    undo(open);
    log(mission_time, open.fault, "end");
  }
}

bool FaultInjector::inject(const Fault& fault) {
  const FlightParents& parents = targets_.parents;
  switch (fault.kind) {
    case FaultKind::kKillAgent:
      return signal(agent_of(parents, fault.agent), SIGKILL);
    case FaultKind::kFreezeAgent:
    case FaultKind::kHangAgent:
      return signal(agent_of(parents, fault.agent), SIGSTOP);
    case FaultKind::kKillPlanner:
      return signal(planner_of(parents), SIGKILL);
    case FaultKind::kFreezePlanner:
    case FaultKind::kHangPlanner:
      return signal(planner_of(parents), SIGSTOP);
    case FaultKind::kFreezeLauncher:
      return signal(parents.launcher, SIGSTOP);
    case FaultKind::kKillGateway:
      return signal(gateway_of(parents), SIGKILL);
    case FaultKind::kFreezeGateway:
      return signal(gateway_of(parents), SIGSTOP);
    case FaultKind::kPause:
      return command({"pause"});
    case FaultKind::kAddObstacle:
      return add_obstacle(fault);
    case FaultKind::kFillDisk:
      return targets_.disk != nullptr && targets_.disk->fill();
    case FaultKind::kStepClock:
      if (targets_.clock != nullptr) targets_.clock->step(fault.step_s);
      return targets_.clock != nullptr;
    case FaultKind::kCutHosts:
      return targets_.hosts != nullptr && targets_.hosts->pull_cable();
  }
  return false;
}

void FaultInjector::undo(const Open& open) {
  switch (open.fault.kind) {
    case FaultKind::kFreezeAgent:
    case FaultKind::kFreezePlanner:
    case FaultKind::kFreezeLauncher:
    case FaultKind::kFreezeGateway:
      ::kill(open.frozen, SIGCONT);
      break;
    case FaultKind::kPause:
      command({"resume"});
      break;
    case FaultKind::kFillDisk:
      targets_.disk->free();
      break;
    case FaultKind::kStepClock:
      targets_.clock->step(-open.fault.step_s);
      break;
    case FaultKind::kCutHosts:
      targets_.hosts->plug_cable();
      break;
    default:
      break;
  }
}

bool FaultInjector::signal(std::optional<pid_t> pid, int number) {
  if (!pid || ::kill(*pid, number) != 0) return false;
  signalled_ = *pid;
  return true;
}

// Not waited for: the launcher may be frozen.
bool FaultInjector::command(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(),
                   {sibling_program("swarm_launcher"), "command", targets_.run_dir.string()});
  return start_process(arguments, targets_.run_dir.string() + ".commands.log").has_value();
}

/// Whether the launcher may add an obstacle seconds late, as it is frozen or about to be, or
/// whether the robot logs have no present positions.
bool FaultInjector::is_command_delayed(Duration mission_time) const {
  const auto delays = [](FaultKind kind) {
    return kind == FaultKind::kFreezeLauncher || kind == FaultKind::kFillDisk;
  };
  const auto comes = [&](const Fault& fault) {
    return delays(fault.kind) && fault.at >= mission_time && fault.at < mission_time + kCommandTime;
  };
  return std::ranges::any_of(open_, [&](const Open& open) { return delays(open.fault.kind); }) ||
         std::ranges::any_of(schedule_, comes);
}

/// Away from all robots: one that an obstacle appears on has touched it, whatever it does. The
/// other host of two has logs of its own.
bool FaultInjector::add_obstacle(const Fault& fault) {
  if (targets_.hosts != nullptr || is_command_delayed(fault.at)) return false;
  const Box& map = targets_.bounds_m;
  Vec2 share(fault.x_share, fault.y_share);
  for (int tried = 0; tried < kPlaces; ++tried) {
    const Vec2 at_m = map.min_m + share.cwiseProduct(map.max_m - map.min_m);
    if (is_clear_of_robots(targets_.run_dir, at_m, kAway_m)) {
      return command(
          {"add_obstacle",
           fmt::format("circle_m: {{center: [{:.2f}, {:.2f}], radius: 0.4}}", at_m.x(), at_m.y())});
    }
    share = Vec2(std::fmod(share.x() + kNextX, 1.0), std::fmod(share.y() + kNextY, 1.0));
  }
  return false;
}

// Beside the run directory, whose disk may be full.
void FaultInjector::log(Duration mission_time, const Fault& fault, const char* edge) const {
  nlohmann::ordered_json line = {
      {"t_s", to_seconds(mission_time)}, {"fault", to_string(fault.kind)}, {"edge", edge}};
  if (loses_robots(fault.kind) || fault.kind == FaultKind::kFreezeAgent) {
    line["agent"] = fault.agent;
  }
  if (fault.kind == FaultKind::kStepClock) line["step_s"] = fault.step_s;
  std::ofstream(targets_.run_dir.string() + ".chaos.jsonl", std::ios::app) << line.dump() << '\n';
}

}  // namespace swarm::launcher
