// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "swarm_core/mission/channel.hpp"
#include "swarm_launcher/processes/agent_dds.hpp"
#include "swarm_launcher/flight/monitors.hpp"

namespace swarm::launcher {

/// How a mission is flown, as its user chooses.
struct FlightChoices {
  std::uint64_t seed = 1;
  std::string fault{};               ///< as parse_link_faults() reads it
  std::filesystem::path out{};       ///< run directory; empty: runs/<mission>-<time>
  std::filesystem::path agent_program{};    ///< empty: our robot_agent
  std::filesystem::path planner_program{};  ///< empty: our planner_service
  int domain = -1;                   ///< DDS domain; negative: a free one
  std::optional<Channel> channel{};  ///< empty: choose_channel() decides
  AgentDds agent_dds = AgentDds::kFastDds;
  bool cyclone_launcher = false;
  bool cyclone_planner = false;
  std::uint32_t by_gateway = 0;  ///< agent processes, the first ones, whose states go by topics
  std::string interface = "127.0.0.1";  ///< address of the network's interface
  std::uint32_t remote = 0;             ///< robots that other hosts start: the last ones
  std::uint16_t join_port = 0;          ///< where those hosts come to; 0: a free one
  MonitorOptions monitors{};            ///< what looks on
};

}  // namespace swarm::launcher
