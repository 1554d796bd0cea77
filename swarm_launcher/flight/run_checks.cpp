// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/run_checks.hpp"

#include <utility>

#include <fmt/format.h>

#include "swarm_core/mission/link_faults.hpp"
#include "swarm_core/mission/placement.hpp"
#include "swarm_link/roles/join.hpp"
#include "swarm_link/udp_socket.hpp"
#include "swarm_link/vendor.hpp"

namespace swarm::launcher {
namespace {

// Several hosts need static peers, which the groups channel uses: the discovery server is bound to
// loopback. The last robots are those of other hosts, so what is left must be whole processes.
Result<void> check_remote(const FlightOptions& options) {
  const std::uint32_t robots = options.mission.robots.count;
  const std::uint32_t remote = options.how.remote;
  if (remote == 0) return {};
  if (options.how.channel.value_or(Channel::kGroups) != Channel::kGroups) {
    return fail(ErrorCode::kBadInput, "--remote: robots of several hosts meet by --channel groups");
  }
  if (remote > robots || (robots - remote) % options.per_process != 0) {
    return fail(ErrorCode::kBadInput,
                fmt::format("--remote {}: of {} robots that many must be there, and what is left "
                            "must be whole processes of {}",
                            remote, robots, options.per_process));
  }
  return {};
}

// Refuses DDS implementations that the channel or this build does not support.
Result<void> check_vendors(const FlightChoices& how, Channel channel,
                           const RunAbilities& abilities) {
  const bool cyclone = how.dds.any(link::Vendor::kCycloneDds) || how.by_gateway > 0;
  if (cyclone && channel != Channel::kGroups) {
    return fail(ErrorCode::kBadInput,
                "Cyclone DDS joins without a discovery server; add --channel groups");
  }
  if (cyclone && !abilities.cyclonedds) {
    return fail(ErrorCode::kBadInput, "this program was built without Cyclone DDS");
  }
  if (how.by_gateway > 0 && !abilities.fastdds) {
    return fail(ErrorCode::kBadInput,
                "--by-gateway: the gateway speaks Fast DDS, which this program was built without");
  }
  return {};
}

}  // namespace

RunAbilities abilities_of(const FlightOptions& options) {
  return {.fastdds = link::built_with(link::Vendor::kFastDds),
          .cyclonedds = link::built_with(link::Vendor::kCycloneDds),
          .multicast = link::carries_multicast(options.how.interface)};
}

// The agents place their robots themselves; placing them here finds out early whether that works.
Result<CheckedRun> check_run(FlightOptions options, const RunAbilities& abilities) {
  FlightChoices& how = options.how;
  if (const auto faults = parse_link_faults(how.fault); !faults) {
    return tl::unexpected(faults.error());
  }
  if (const auto places = place_robots(options.mission, how.seed); !places) {
    return tl::unexpected(places.error());
  }
  if (const auto checked = check_remote(options); !checked) {
    return tl::unexpected(checked.error());
  }
  if (how.remote > 0) how.channel = Channel::kGroups;
  // A build with Cyclone DDS only uses it for all processes.
  if (!abilities.fastdds) {
    how.dds = {.launcher = link::Vendor::kCycloneDds,
               .planner = link::Vendor::kCycloneDds,
               .agents = link::Vendor::kCycloneDds};
    if (!how.channel) how.channel = Channel::kGroups;
  }
  auto channel = choose_channel({.wanted = how.channel,
                                 .agents = options.agents(),
                                 .robots_per_process = options.per_process,
                                 .multicast = abilities.multicast});
  if (!channel) return tl::unexpected(channel.error());
  if (const auto fits = check_vendors(how, channel->channel, abilities); !fits) {
    return tl::unexpected(fits.error());
  }
  const std::uint32_t relays =
      channel->channel == Channel::kGroups ? link::relays_for(options.agents()) : 0;
  return CheckedRun{
      .options = std::move(options), .channel = std::move(*channel), .relays = relays};
}

}  // namespace swarm::launcher
