// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/program/driver_check_program.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "robot_agent/check/driver_check.hpp"
#include "robot_agent/program/agent_process.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_core/mission/placement.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::agent {
namespace {

using Verdict = ClauseResult::Verdict;

struct SteadyCheckClock final : CheckClock {
  SteadyTime now() override { return std::chrono::steady_clock::now(); }
  void sleep_until(SteadyTime time) override { std::this_thread::sleep_until(time); }
};

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kKept:
      return "kept";
    case Verdict::kBroken:
      return "broken";
    case Verdict::kNotTried:
      break;
  }
  return "not tried";
}

void print(const std::vector<ClauseResult>& results, bool json) {
  if (!json) {
    for (const ClauseResult& r : results) {
      std::fputs(fmt::format("{:9}  {:9}  {}\n", name_of(r.verdict), r.clause, r.text).c_str(),
                 stdout);
    }
    return;
  }
  auto clauses = nlohmann::ordered_json::array();
  for (const ClauseResult& r : results) {
    clauses.push_back({{"clause", r.clause}, {"verdict", name_of(r.verdict)}, {"text", r.text}});
  }
  std::fputs((nlohmann::ordered_json{{"clauses", clauses}}.dump() + "\n").c_str(), stdout);
}

}  // namespace

Result<ExitCode> run_driver_check(const DriverCheckRequest& request,
                                  const RobotRegistry& registry) {
  const auto mission = load_mission(request.mission, catalogue_of(registry));
  if (!mission) return tl::unexpected(mission.error());
  if (request.robot >= mission->robots.count) {
    return fail(ErrorCode::kBadInput,
                fmt::format("--ids: the mission has robots 0 to {}", mission->robots.count - 1));
  }
  const RobotId robot(request.robot);
  const std::string& name = body_of(mission->robots, robot).model;
  const DriverEntry* entry = registry.drivers.find(name);
  if (entry == nullptr) {
    return fail(ErrorCode::kBadInput,
                fmt::format("robots.model is {}, which this program does not have", name));
  }
  constexpr std::uint64_t kSeed = 1;
  const auto places = place_robots(*mission, kSeed);
  if (!places) return tl::unexpected(places.error());
  DriverCheckOptions options = DriverCheckOptions::of(*mission, robot);
  options.room_m = request.room_m;
  if (request.speed_mps > 0.0) {
    options.speed_mps = std::min(request.speed_mps, body_of(mission->robots, robot).speed_max_mps);
  }
  options.may_kill = request.may_kill;
  if (!request.cut_pose.empty()) {
    options.cut_pose = [&](bool is_cut) {
      const std::string command = request.cut_pose + (is_cut ? " cut" : " restore");
      const int code = std::system(command.c_str());
      if (code != 0) std::fputs(fmt::format("{}: ended with {}\n", command, code).c_str(), stderr);
      return code == 0;
    };
  }
  // Ctrl-C stops the robot instead of leaving it to its watchdog.
  shell::catch_stop_signals();
  options.must_end = [] { return shell::stop_requests() > 0; };
  SteadyCheckClock clock;
  const auto results = check_driver(
      [&] {
        return entry->make({.mission = *mission,
                            .robot = robot,
                            .position_m = (*places)[robot.value()],
                            .now = clock.now(),
                            .seed = kSeed});
      },
      options, clock);
  print(results, request.json);
  const bool is_broken = std::ranges::any_of(
      results, [](const ClauseResult& r) { return r.verdict == Verdict::kBroken; });
  return is_broken ? ExitCode::kCriteriaNotMet : ExitCode::kOk;
}

}  // namespace swarm::agent
