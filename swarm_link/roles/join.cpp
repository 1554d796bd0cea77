// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/roles/join.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "swarm_link/adapters/cyclone/cyclone_participant.hpp"
#include "swarm_link/announcement_port.hpp"
#include "swarm_link/roles/relay_participant.hpp"

namespace swarm::link {
namespace {

// Discovery of one Fast DDS participant costs the square of its peers; 25 are quick to discover.
constexpr std::uint32_t kAgentsPerRelay = 25;

// Participant indices, in this order: launcher, planner, gateway, agents. All participants of a
// Cyclone process share its port, so such a launcher or planner is one relay participant.
std::uint32_t launcher_index(const Meeting& m, std::uint32_t relay) {
  return m.launcher == Vendor::kCycloneDds ? 0 : relay;
}
std::uint32_t planner_index(const Meeting& m, std::uint32_t relay) {
  return std::max(1U, m.relays) + (m.planner == Vendor::kCycloneDds ? 0 : relay);
}
std::uint32_t gateway_index(const Meeting& m) { return 2 * std::max(1U, m.relays); }
std::uint32_t agent_index(const Meeting& m, std::uint32_t number) {
  return gateway_index(m) + 1 + number;
}

// Options common to all roles.
FastDdsOptions member(const Meeting& meeting, std::string name, std::uint32_t index) {
  return {.name = std::move(name),
          .domain = meeting.domain,
          .index = index,
          .discovery = meeting.server,
          .interface = meeting.interface,
          .faults = meeting.faults};
}

// Creates a participant and reports at once if it cannot receive.
Result<std::unique_ptr<Participant>> make_checked(const FastDdsOptions& options) {
  auto made = make_fastdds_participant(options);
  if (!made) return made;
  if (const auto can_receive = (*made)->self_check(); !can_receive)
    return tl::unexpected(can_receive.error());
  return made;
}

// Launcher or planner with Cyclone DDS: a fixed index, so that agents know its port, and the other
// of the two as its peer.
CycloneOptions cyclone_relay(const Meeting& meeting, std::string name, std::uint32_t index,
                             std::uint32_t peer) {
  return {.name = std::move(name),
          .domain = meeting.domain,
          .peer_ports = {announcement_port(meeting.domain, peer)},
          .peer_host = meeting.host,
          .index = index,
          .interface = meeting.interface};
}

tl::unexpected<Error> no_server_for_cyclone(const char* role) {
  return fail(
      ErrorCode::kBadInput,
      fmt::format("--dds {}cyclonedds: a discovery server of Fast DDS is not for Cyclone DDS; "
                  "use --channel groups, whose processes meet without one",
                  role));
}

}  // namespace

std::uint32_t relays_for(std::uint32_t agents) {
  return std::max(1U, (agents + kAgentsPerRelay - 1) / kAgentsPerRelay);
}

// Some indices after the agents' are for monitors that join later.
std::uint32_t participants_for(const Meeting& meeting, std::uint32_t agents) {
  constexpr std::uint32_t kMonitors = 4;
  return agent_index(meeting, agents + kMonitors);
}

std::uint32_t fixed_participants(const Meeting& meeting) {
  return meeting.relays == 0 ? 0 : gateway_index(meeting) + 1;
}

bool built_with(Vendor vendor) {
  return vendor == Vendor::kFastDds ? SWARM_WITH_FASTDDS : SWARM_WITH_CYCLONEDDS;
}

// With static peers the launcher announces itself to no one: planner and agents announce themselves
// to its relay participants.
Result<std::unique_ptr<Participant>> join_as_launcher(const Meeting& meeting) {
  if (meeting.launcher == Vendor::kCycloneDds) {
    if (meeting.relays == 0) return no_server_for_cyclone("launcher=");
    return make_cyclone_participant(cyclone_relay(
        meeting, "swarm_launcher", launcher_index(meeting, 0), planner_index(meeting, 0)));
  }
  std::vector<std::unique_ptr<Participant>> relays;
  for (std::uint32_t relay = 0; relay < std::max(1U, meeting.relays); ++relay) {
    FastDdsOptions options = member(meeting, "swarm_launcher", launcher_index(meeting, relay));
    if (meeting.relays > 0) options.static_peers = StaticPeers{.is_relay = true};
    auto made = make_checked(options);
    if (!made) return made;
    relays.push_back(std::move(*made));
  }
  return make_relay_participant(std::move(relays));
}

Result<std::unique_ptr<Participant>> join_as_planner(const Meeting& meeting) {
  if (meeting.planner == Vendor::kCycloneDds) {
    if (meeting.relays == 0) return no_server_for_cyclone("planner=");
    return make_cyclone_participant(cyclone_relay(
        meeting, "planner_service", planner_index(meeting, 0), launcher_index(meeting, 0)));
  }
  std::vector<std::unique_ptr<Participant>> relays;
  for (std::uint32_t relay = 0; relay < std::max(1U, meeting.relays); ++relay) {
    FastDdsOptions options = member(meeting, "planner_service", planner_index(meeting, relay));
    if (meeting.relays > 0) options.static_peers = StaticPeers{.is_relay = true};
    // One connection between launcher and planner is enough, so only one relay participant of the
    // planner announces itself.
    if (meeting.relays > 0 && relay == 0) {
      options.static_peers->peers = {launcher_index(meeting, 0)};
      options.static_peers->host = meeting.host;
    }
    auto made = make_checked(options);
    if (!made) return made;
    relays.push_back(std::move(*made));
  }
  return make_relay_participant(std::move(relays));
}

// A monitor receives cells by unicast, so that it works on interfaces without multicast.
Result<std::unique_ptr<Participant>> join_as_monitor(const Meeting& meeting, std::uint32_t agents,
                                                     std::uint32_t number) {
  FastDdsOptions options = member(meeting, "swarm_monitor", agent_index(meeting, agents + number));
  if (meeting.relays > 0) {
    options.static_peers = StaticPeers{
        .peers = {launcher_index(meeting, 0), planner_index(meeting, 0)}, .host = meeting.host};
  }
  options.cells_by_multicast = false;
  return make_checked(options);
}

Result<ReplayParticipants> join_as_replay(const Meeting& meeting) {
  FastDdsOptions options = member(meeting, "replay", launcher_index(meeting, 0));
  options.static_peers = StaticPeers{.is_relay = true};
  auto launcher = make_checked(options);
  if (!launcher) return tl::unexpected(launcher.error());
  options.index = planner_index(meeting, 0);
  auto planner = make_checked(options);
  if (!planner) return tl::unexpected(planner.error());
  return ReplayParticipants{std::move(*launcher), std::move(*planner)};
}

Result<std::unique_ptr<Participant>> join_as_gateway(const Meeting& meeting) {
  FastDdsOptions options = member(meeting, "gateway", gateway_index(meeting));
  options.static_peers = StaticPeers{.is_relay = true};
  options.cells_by_multicast = false;
  return make_checked(options);
}

// Agents are distributed over the relay participants in turn; each announces itself to one of the
// launcher and the corresponding one of the planner.
Result<std::unique_ptr<Participant>> join_as_agent(const Meeting& meeting, std::uint32_t number,
                                                   const std::string& name, Vendor vendor,
                                                   bool by_gateway) {
  std::vector<std::uint32_t> relays;
  if (meeting.relays > 0) {
    const std::uint32_t relay = number % meeting.relays;
    relays = {launcher_index(meeting, relay), planner_index(meeting, relay)};
    if (by_gateway) relays.push_back(gateway_index(meeting));
  }
  if (vendor == Vendor::kCycloneDds) {
    if (relays.empty()) return no_server_for_cyclone("");
    CycloneOptions options{.name = name,
                           .domain = meeting.domain,
                           .peer_host = meeting.host,
                           .interface = meeting.interface};
    for (const std::uint32_t relay : relays) {
      options.peer_ports.push_back(announcement_port(meeting.domain, relay));
    }
    return make_cyclone_participant(options);
  }
  FastDdsOptions options = member(meeting, name, agent_index(meeting, number));
  if (!relays.empty())
    options.static_peers = StaticPeers{.peers = std::move(relays), .host = meeting.host};
  return make_checked(options);
}

}  // namespace swarm::link
