// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_launcher/supervision/supervisor.hpp"

namespace swarm::launcher {

using std::chrono::milliseconds;
using std::chrono::seconds;

inline RobotReport report_of(SteadyTime sent_at) {
  return {.has_plan = true,
          .receives_neighbours = true,
          .mode = RobotMode::kMoving,
          .sent_at = sent_at};
}

/// Drives a supervisor with a simulated clock and plays the part of its processes.
struct SupervisorBench {
  SteadyTime now{seconds(100)};
  SupervisorOptions options;
  std::optional<Supervisor> sut;
  std::vector<std::uint32_t> started;
  std::vector<CommandKind> commands;
  std::vector<SceneChange> changes;
  std::vector<std::pair<std::uint32_t, EndSignal>> signals;
  std::vector<std::vector<RobotId>> fallen, risen;  // one entry a step
  std::vector<std::string> log;
  bool obedient = true;             // children end when they are asked to
  std::uint64_t planner_epoch = 0;  ///< its heartbeats arrive all the time; 0: none
  std::vector<RobotId> reporting;   ///< their statuses arrive all the time

  explicit SupervisorBench(std::uint32_t robots, std::uint32_t per_process = 1) {
    options.robots = robots;
    options.per_process = per_process;
    options.launcher.starts_per_s = 10.0;
    // The processes of most tests report once: they are not about silence.
    constexpr SilenceLimits kNever{std::chrono::hours(1000), std::chrono::hours(1000)};
    options.agent_silence = options.planner_silence = kNever;
  }

  void run_for(Duration d) {
    if (!sut) sut.emplace(options, now);
    for (const SteadyTime until = now + d; now < until; now += milliseconds(50)) {
      if (planner_epoch != 0) sut->on_heartbeat(planner_epoch);
      for (const RobotId robot : reporting) sut->on_status(robot, report_of(now));
      for (const Action& action : sut->step(now)) take(action);
    }
  }

  void take(const Action& action) {
    if (const auto* start = std::get_if<StartProcess>(&action))
      started.push_back(start->process.value());
    if (const auto* command = std::get_if<SendCommand>(&action)) commands.push_back(command->kind);
    if (const auto* scene = std::get_if<ChangeScene>(&action)) {
      changes.push_back(scene->change);
      if (std::holds_alternative<GoTo>(scene->change)) sut->on_new_goal(77);
    }
    if (const auto* bodies = std::get_if<AddBodies>(&action)) fallen.push_back(bodies->robots);
    if (const auto* bodies = std::get_if<ClearBodies>(&action)) risen.push_back(bodies->robots);
    if (const auto* event = std::get_if<LogEvent>(&action))
      log.push_back(event->code + ": " + event->text);
    if (const auto* signal = std::get_if<SignalProcess>(&action)) {
      signals.emplace_back(signal->process.value(), signal->signal);
      if (obedient) sut->on_exit(signal->process, {}, now);
    }
  }

  void report_all(RobotMode mode, bool settled = false, std::uint64_t scene_version = 0) {
    for (std::uint32_t i = 0; i < options.robots; ++i) {
      sut->on_status(RobotId(i), {true, true, mode, settled, scene_version});
    }
  }

  bool logged(const std::string& fragment) const {
    return std::any_of(log.begin(), log.end(),
                       [&](const std::string& l) { return l.find(fragment) != std::string::npos; });
  }
};

/// The same with all robots ready, so that the mission runs.
struct RunningBench : SupervisorBench {
  explicit RunningBench(std::uint32_t robots, std::uint32_t per_process = 1)
      : SupervisorBench(robots, per_process) {}
  void start() {
    run_for(seconds(2));
    report_all(RobotMode::kWaiting);
    run_for(milliseconds(100));
    ASSERT_EQ(sut->stage(), Supervisor::Stage::kRunning);
  }
};

using Robots = std::vector<std::vector<RobotId>>;

}  // namespace swarm::launcher
