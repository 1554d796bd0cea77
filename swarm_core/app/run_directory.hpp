// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"
#include "swarm_core/mission/channel.hpp"

/// A run's directory: where the launcher, the planner, the agents and the monitor meet.
namespace swarm::shell {

inline constexpr std::string_view kMissionFile = "mission.resolved.yaml";
inline constexpr std::string_view kPlanFile = "plan.json";
inline constexpr std::string_view kPlanStatsFile = "plan_stats.json";
inline constexpr std::string_view kPlanningFile = "planning.json";
inline constexpr std::string_view kPlanClockFile = "plan_clock.jsonl";
inline constexpr std::string_view kSummaryFile = "summary.json";
inline constexpr std::string_view kEventsFile = "events.jsonl";
inline constexpr std::string_view kSceneFile = "scene.jsonl";
inline constexpr std::string_view kRunFile = "run.json";
inline constexpr std::string_view kControlSocket = "control.sock";
inline constexpr std::string_view kLogsFolder = "logs";
inline constexpr std::string_view kRobotLogFolder = "blackbox";

/// How to join a run; `run.json`.
struct RunInfo {
  std::uint32_t domain = 0;
  std::string discovery_host = "127.0.0.1";
  std::uint16_t discovery_port = 0;
  std::uint32_t agents = 0;       ///< processes
  std::uint32_t relays = 0;         ///< of launcher and planner each; 0: everyone meets at the server
  bool cyclone_launcher = false;  ///< whose DDS the launcher speaks
  bool cyclone_planner = false;   ///< whose DDS the planner speaks
  std::string host = "127.0.0.1";       ///< where launcher and planner are
  std::string interface = "127.0.0.1";  ///< address of the interface robots here speak on
  Channel channel = Channel::kTopics;
  std::uint64_t seed = 0;
  UtcTime began{};
};

Result<void> write_run_info(const std::filesystem::path& run_dir, const RunInfo& info);
Result<RunInfo> read_run_info(const std::filesystem::path& run_dir);

/// Writes a whole file under a temporary name and renames it, so that readers never see half of it.
Result<void> write_file(const std::filesystem::path& file, std::string_view content);
Result<std::string> read_file(const std::filesystem::path& file, std::size_t max_bytes);

}  // namespace swarm::shell
