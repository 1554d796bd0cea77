// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "swarm_core/app/run_clock.hpp"
#include "swarm_core/mission/channel.hpp"
#include "swarm_core/mission/vendor.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"

/// The directory of a run: the files by which launcher, planner, agents and monitor exchange what
/// does not go over the bus.
namespace swarm::shell {

/// Names of the files and folders of a run directory, as they are on disk.
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

/// Plans behind the first one that a run directory keeps; the planner removes older ones.
inline constexpr std::uint32_t kPlansKept = 100;

/// How to join a run; `run.json`.
struct RunInfo {
  std::uint32_t domain = 0;
  std::string discovery_host = "127.0.0.1";
  std::uint16_t discovery_port = 0;
  std::uint32_t agents = 0;  ///< number of agent processes
  /// Relay participants of launcher and planner each; 0: all use the discovery server.
  std::uint32_t relays = 0;
  link::Vendor launcher = link::Vendor::kFastDds;  ///< DDS of the launcher
  link::Vendor planner = link::Vendor::kFastDds;   ///< DDS of the planner
  std::string host = "127.0.0.1";                  ///< address of the host of launcher and planner
  std::string interface = "127.0.0.1";  ///< address of the interface that robots of this host use
  Channel channel = Channel::kTopics;
  std::uint64_t seed = 0;
  UtcTime began{};
  RunClock clock{};        ///< of the host that this file is on
  bool is_replay = false;  ///< a recording is published again: its stamps are old
};

/// The content of `run.json`.
std::string to_json(const RunInfo& info);
/// Writes `run.json`, atomically.
Result<void> write_run_info(const std::filesystem::path& run_dir, const RunInfo& info);
/// Reads `run.json`; kBadInput if it is missing, lacks a key, or has a value out of its range.
Result<RunInfo> read_run_info(const std::filesystem::path& run_dir);
/// Reads a file of another name with the same content.
Result<RunInfo> read_run_info_file(const std::filesystem::path& file);

/// Writes a whole file under a temporary name and renames it, so that readers never see half of it.
Result<void> write_file(const std::filesystem::path& file, std::string_view content);
/// The content of a file of at most `max_bytes`; kBadInput if it is larger or cannot be read.
Result<std::string> read_file(const std::filesystem::path& file, std::size_t max_bytes);

}  // namespace swarm::shell
