// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "swarm_core/base/result.hpp"
#include "swarm_core/mission/channel.hpp"
#include "swarm_launcher/agent_dds.hpp"
#include "swarm_launcher/monitors.hpp"

namespace swarm::launcher {

struct RunOptions {
  std::filesystem::path mission_file;
  std::optional<std::uint32_t> robots;       ///< instead of the mission's
  std::uint32_t per_process = 1;             ///< robots, unless …
  std::optional<std::uint32_t> processes{};  ///< of agents; 0: as the machine can take
  std::uint64_t seed = 1;
  std::string fault;          ///< as parse_link_faults() reads it
  std::filesystem::path out;  ///< run directory; empty: runs/<mission>-<time>
  bool json = false;
  int domain = -1;                 ///< DDS domain; negative: a free one
  std::optional<Channel> channel;  ///< empty: choose_channel() decides
  AgentDds agent_dds = AgentDds::kFastDds;
  bool cyclone_launcher = false;
  bool cyclone_planner = false;
  std::uint32_t by_gateway = 0;         ///< agent processes whose states go by topics
  std::string interface = "127.0.0.1";  ///< address of the network's interface
  std::uint32_t remote = 0;             ///< robots that other hosts start
  std::uint16_t join_port = 0;          ///< where those hosts come to; 0: a free one
  MonitorOptions monitors{};            ///< what looks on
};

/// `swarm_launcher run`: the whole mission with real processes, from planning to the audited
/// report. Result on stdout, progress on stderr.
Result<ExitCode> run_mission(const RunOptions& options);

}  // namespace swarm::launcher
