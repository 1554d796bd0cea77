// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/join.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "swarm_link/announcement_port.hpp"
#include "swarm_link/cyclone/cyclone_participant.hpp"
#include "swarm_link/hub.hpp"

namespace swarm::link {
namespace {

constexpr std::uint32_t kAgentsPerHub = 25;

// Participant indices: the launcher's, the planner's, the gateway's, then the agents'. All
// participants of a Cyclone process share their port: such a launcher or planner is one hub.
std::uint32_t launcher_index(const Meeting& m, std::uint32_t hub) {
  return m.launcher == Vendor::kCycloneDds ? 0 : hub;
}
std::uint32_t planner_index(const Meeting& m, std::uint32_t hub) {
  return std::max(1U, m.hubs) + (m.planner == Vendor::kCycloneDds ? 0 : hub);
}
std::uint32_t gateway_index(const Meeting& m) { return 2 * std::max(1U, m.hubs); }
std::uint32_t agent_index(const Meeting& m, std::uint32_t number) {
  return gateway_index(m) + 1 + number;
}

FastDdsOptions member(const Meeting& meeting, std::string name, std::uint32_t index) {
  return {.name = std::move(name),
          .domain = meeting.domain,
          .index = index,
          .discovery = meeting.server,
          .interface = meeting.interface,
          .faults = meeting.faults};
}

Result<std::unique_ptr<Participant>> make_checked(const FastDdsOptions& options) {
  auto made = make_fastdds_participant(options);
  if (!made) return made;
  if (const auto hears = (*made)->self_check(); !hears) return tl::unexpected(hears.error());
  return made;
}

CycloneOptions cyclone_hub(const Meeting& meeting, std::string name, std::uint32_t index,
                           std::uint32_t peer) {
  return {.name = std::move(name),
          .domain = meeting.domain,
          .peer_ports = {announcement_port(meeting.domain, peer)},
          .peer_host = meeting.host,
          .index = index,
          .interface = meeting.interface};
}

tl::unexpected<Error> no_server_for_cyclone(const char* option) {
  return fail(ErrorCode::kBadInput,
              fmt::format("{} cyclonedds: a discovery server of Fast DDS is not for Cyclone DDS; "
                          "use --channel groups, whose processes meet without one",
                          option));
}

}  // namespace

std::uint32_t hubs_for(std::uint32_t agents) {
  return std::max(1U, (agents + kAgentsPerHub - 1) / kAgentsPerHub);
}

std::uint32_t participants_for(const Meeting& meeting, std::uint32_t agents) {
  constexpr std::uint32_t kMonitors = 4;
  return agent_index(meeting, agents + kMonitors);
}

bool built_with(Vendor vendor) {
  return vendor == Vendor::kFastDds ? SWARM_WITH_FASTDDS : SWARM_WITH_CYCLONEDDS;
}

Result<std::unique_ptr<Participant>> join_as_launcher(const Meeting& meeting) {
  if (meeting.launcher == Vendor::kCycloneDds) {
    if (meeting.hubs == 0) return no_server_for_cyclone("--launcher-dds");
    return make_cyclone_participant(cyclone_hub(
        meeting, "swarm_launcher", launcher_index(meeting, 0), planner_index(meeting, 0)));
  }
  std::vector<std::unique_ptr<Participant>> hubs;
  for (std::uint32_t hub = 0; hub < std::max(1U, meeting.hubs); ++hub) {
    FastDdsOptions options = member(meeting, "swarm_launcher", launcher_index(meeting, hub));
    if (meeting.hubs > 0) options.star = Star{.is_hub = true};
    auto made = make_checked(options);
    if (!made) return made;
    hubs.push_back(std::move(*made));
  }
  return make_hub(std::move(hubs));
}

Result<std::unique_ptr<Participant>> join_as_planner(const Meeting& meeting,
                                                     std::uint32_t ownership_strength) {
  if (meeting.planner == Vendor::kCycloneDds) {
    if (meeting.hubs == 0) return no_server_for_cyclone("--planner-dds");
    CycloneOptions options = cyclone_hub(meeting, "planner_service", planner_index(meeting, 0),
                                         launcher_index(meeting, 0));
    options.ownership_strength = ownership_strength;
    return make_cyclone_participant(options);
  }
  std::vector<std::unique_ptr<Participant>> hubs;
  for (std::uint32_t hub = 0; hub < std::max(1U, meeting.hubs); ++hub) {
    FastDdsOptions options = member(meeting, "planner_service", planner_index(meeting, hub));
    options.ownership_strength = ownership_strength;
    if (meeting.hubs > 0) options.star = Star{.is_hub = true};
    // Of all its hubs one is enough for what launcher and planner have to tell each other.
    if (meeting.hubs > 0 && hub == 0) {
      options.star->peers = {launcher_index(meeting, 0)};
      options.star->host = meeting.host;
    }
    auto made = make_checked(options);
    if (!made) return made;
    hubs.push_back(std::move(*made));
  }
  return make_hub(std::move(hubs));
}

Result<std::unique_ptr<Participant>> join_as_monitor(const Meeting& meeting, std::uint32_t agents,
                                                     std::uint32_t number) {
  FastDdsOptions options = member(meeting, "swarm_monitor", agent_index(meeting, agents + number));
  if (meeting.hubs > 0) {
    options.star = Star{.peers = {launcher_index(meeting, 0), planner_index(meeting, 0)},
                        .host = meeting.host};
  }
  options.cells_by_multicast = false;
  return make_checked(options);
}

Result<Stage> join_as_stage(const Meeting& meeting) {
  FastDdsOptions options = member(meeting, "replay", launcher_index(meeting, 0));
  options.star = Star{.is_hub = true};
  auto launcher = make_checked(options);
  if (!launcher) return tl::unexpected(launcher.error());
  options.index = planner_index(meeting, 0);
  auto planner = make_checked(options);
  if (!planner) return tl::unexpected(planner.error());
  return Stage{std::move(*launcher), std::move(*planner)};
}

Result<std::unique_ptr<Participant>> join_as_gateway(const Meeting& meeting) {
  FastDdsOptions options = member(meeting, "gateway", gateway_index(meeting));
  options.star = Star{.is_hub = true};
  options.cells_by_multicast = false;
  return make_checked(options);
}

Result<std::unique_ptr<Participant>> join_as_agent(const Meeting& meeting, std::uint32_t number,
                                                   const std::string& name, Vendor vendor,
                                                   bool by_gateway) {
  std::vector<std::uint32_t> hubs;
  if (meeting.hubs > 0) {
    const std::uint32_t hub = number % meeting.hubs;
    hubs = {launcher_index(meeting, hub), planner_index(meeting, hub)};
    if (by_gateway) hubs.push_back(gateway_index(meeting));
  }
  if (vendor == Vendor::kCycloneDds) {
    if (hubs.empty()) return no_server_for_cyclone("--dds");
    CycloneOptions options{.name = name,
                           .domain = meeting.domain,
                           .peer_host = meeting.host,
                           .interface = meeting.interface};
    for (const std::uint32_t hub : hubs) {
      options.peer_ports.push_back(announcement_port(meeting.domain, hub));
    }
    return make_cyclone_participant(options);
  }
  FastDdsOptions options = member(meeting, name, agent_index(meeting, number));
  if (!hubs.empty()) options.star = Star{.peers = std::move(hubs), .host = meeting.host};
  return make_checked(options);
}

}  // namespace swarm::link
