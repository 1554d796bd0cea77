// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "swarm_link/adapters/fastdds/fastdds_participant.hpp"
#include "swarm_link/port.hpp"
#include "swarm_link/vendor.hpp"

/// How the processes of a run come to know each other.
namespace swarm::link {

/// The meeting place of a run. Either a discovery server, through which everyone finds everyone, or
/// a star: launcher and planner have `relays` participants each at known ports, every agent announces
/// itself to one of either, and agents never learn of each other.
struct Meeting {
  std::uint32_t domain = 0;
  DiscoveryAddress server{};  ///< used when `relays` is 0
  std::uint32_t relays = 0;
  Vendor launcher = Vendor::kFastDds;   ///< whose DDS it speaks; Cyclone's only in a star
  Vendor planner = Vendor::kFastDds;    ///< as the launcher
  std::string host = "127.0.0.1";       ///< where launcher and planner are
  std::string interface = "127.0.0.1";  ///< of whoever joins: the address of its interface
  ReceptionFaults faults{};             ///< of whoever joins
};

/// Hubs for a number of agents: about 25 each; with 300 at one, it never gets done with discovery.
std::uint32_t relays_for(std::uint32_t agents);

/// DDS participants of a run, so that all of them have ports of their own.
std::uint32_t participants_for(const Meeting& meeting, std::uint32_t agents);

Result<std::unique_ptr<Participant>> join_as_launcher(const Meeting& meeting);

/// `ownership_strength`: see FastDdsOptions. In a star a planner takes the ports of the one before
/// it, and agents, who announce themselves there for ever, find it.
Result<std::unique_ptr<Participant>> join_as_planner(const Meeting& meeting,
                                                     std::uint32_t ownership_strength);

/// For observers; `number`: of several. It is given of by launcher and planner alone.
Result<std::unique_ptr<Participant>> join_as_monitor(const Meeting& meeting, std::uint32_t agents,
                                                     std::uint32_t number = 0);

/// The places of launcher and planner in a star of one hub each, for a replay.
struct ReplayParticipants {
  std::unique_ptr<Participant> launcher, planner;
};
Result<ReplayParticipants> join_as_replay(const Meeting& meeting);

/// One more hub of a star, at a port that agents who want it know.
Result<std::unique_ptr<Participant>> join_as_gateway(const Meeting& meeting);

/// The `number`th agent process, counted from 0. Cyclone DDS knows no discovery server of the other
/// vendor: it joins a star, and hears without faults.
/// `by_gateway`: meets the gateway as well, whose topics carry the states of a star.
Result<std::unique_ptr<Participant>> join_as_agent(const Meeting& meeting, std::uint32_t number,
                                                   const std::string& name,
                                                   Vendor vendor = Vendor::kFastDds,
                                                   bool by_gateway = false);

}  // namespace swarm::link
