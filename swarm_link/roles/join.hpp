// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "swarm_link/adapters/fastdds/fastdds_participant.hpp"
#include "swarm_link/port.hpp"
#include "swarm_link/vendor.hpp"

/// How the processes of a run discover each other.
namespace swarm::link {

/// How the processes of a run meet. Either through a discovery server, with which every process
/// discovers every other, or with static peers: launcher and planner have `relays` participants
/// each at known ports, every agent announces itself to one relay participant of each, and agents
/// do not discover each other.
struct Meeting {
  std::uint32_t domain = 0;             ///< DDS domain
  DiscoveryAddress server{};            ///< used when `relays` is 0
  std::uint32_t relays = 0;             ///< relay participants each of launcher and planner
  Vendor launcher = Vendor::kFastDds;   ///< its DDS; Cyclone only with static peers
  Vendor planner = Vendor::kFastDds;    ///< as of the launcher
  std::string host = "127.0.0.1";       ///< address of launcher and planner
  std::string interface = "127.0.0.1";  ///< of the joining process: address of its interface
  ReceptionFaults faults{};             ///< of the joining process
};

/// Relay participants for a number of agents: one per 25. With 300 agents at one participant,
/// discovery never completes.
std::uint32_t relays_for(std::uint32_t agents);

/// Upper bound of the DDS participants of a run, for the ports that DomainLock reserves.
std::uint32_t participants_for(const Meeting& meeting, std::uint32_t agents);

/// How many of them, from the first on, others find at fixed ports: the relay participants of
/// launcher, planner and gateway. None with a discovery server.
std::uint32_t fixed_participants(const Meeting& meeting);

/// The launcher's participant, combined of its relay participants if there are static peers.
Result<std::unique_ptr<Participant>> join_as_launcher(const Meeting& meeting);

/// With static peers a restarted planner takes the ports of its predecessor, and agents, which keep
/// announcing themselves there, discover it.
Result<std::unique_ptr<Participant>> join_as_planner(const Meeting& meeting);

/// For monitors; `number` distinguishes several. With static peers only launcher and planner
/// discover it.
Result<std::unique_ptr<Participant>> join_as_monitor(const Meeting& meeting, std::uint32_t agents,
                                                     std::uint32_t number = 0);

/// The participants of launcher and planner, one relay participant each, for a replay.
struct ReplayParticipants {
  std::unique_ptr<Participant> launcher, planner;
};
Result<ReplayParticipants> join_as_replay(const Meeting& meeting);

/// The gateway's relay participant, at a port known to the agents that use the gateway.
Result<std::unique_ptr<Participant>> join_as_gateway(const Meeting& meeting);

/// The `number`th agent process, counted from 0. Cyclone DDS cannot use the discovery server of
/// Fast DDS: it needs static peers, and reception faults are not simulated for it. `by_gateway`:
/// also announces itself to the gateway, whose topics carry the states of a run with static peers.
Result<std::unique_ptr<Participant>> join_as_agent(const Meeting& meeting, std::uint32_t number,
                                                   const std::string& name,
                                                   Vendor vendor = Vendor::kFastDds,
                                                   bool by_gateway = false);

}  // namespace swarm::link
