// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "swarm_core/mission/channel.hpp"
#include "swarm_launcher/flight/monitors.hpp"
#include "swarm_launcher/processes/run_vendors.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm::launcher {

/// How the user wants a mission to be flown.
struct FlightChoices {
  std::uint64_t seed = 1;
  std::string fault{};                      ///< as parse_link_faults() reads it
  std::filesystem::path out{};              ///< run directory; empty: runs/<mission>-<time>
  std::filesystem::path agent_program{};    ///< empty: robot_agent of this build
  std::filesystem::path planner_program{};  ///< empty: planner_service of this build
  int domain = -1;                          ///< DDS domain; negative: a free one
  std::optional<Channel> channel{};         ///< empty: choose_channel() decides
  RunVendors dds{};                         ///< DDS implementations
  std::uint32_t by_gateway = 0;             ///< the first agent processes, which use topics
  std::string interface = "127.0.0.1";      ///< address of the interface to the network
  std::uint32_t remote = 0;                 ///< the last robots, which other hosts start
  std::uint16_t join_port = 0;              ///< TCP port for those hosts; 0: a free one
  std::string join_token{};                 ///< that those hosts must know; empty: none
  MonitorOptions monitors{};                ///< recording and view
};

/// What to fly and how.
struct FlightOptions {
  Mission mission;
  std::uint32_t per_process = 1;  ///< robots of an agent process
  FlightChoices how{};

  /// Agent processes of all hosts.
  std::uint32_t agents() const { return (mission.robots.count + per_process - 1) / per_process; }
};

}  // namespace swarm::launcher
