// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/program/bus_access.hpp"

#include <utility>

#include <fmt/format.h>

#include "swarm_link/channels/groups/group_channel.hpp"
#include "swarm_link/roles/run_meeting.hpp"
#include "swarm_link/topics.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::agent {
namespace {

// Keeps the random numbers of network faults apart from those of the robots.
constexpr std::uint64_t kFaultSeed = 0xFA17;

/// States by UDP multicast, a group per cell.
Result<std::unique_ptr<link::StateChannel>> make_group_channel(
    const LinkSpec& spec, const shell::RunInfo& run, const link::ReceptionFaults& faults) {
  link::GroupChannelOptions groups{
      .domain = run.domain, .interface = run.interface, .faults = faults};
  groups.cells.cell_size_m = spec.group_cell_size_m;
  groups.cells.communication_radius_m = spec.communication_radius_m;
  return link::make_group_channel(groups);
}

}  // namespace

Result<BusAccess> open_endpoints(std::unique_ptr<link::Participant> participant) {
  // The topics that every process has; those of states depend on where robots are.
  auto plan = participant->make_reader(link::plan_topic());
  auto scene = participant->make_reader(link::scene_topic());
  auto heartbeat = participant->make_reader(link::heartbeat_topic());
  auto command = participant->make_reader(link::command_topic());
  auto status = participant->make_writer(link::status_topic());
  auto event = participant->make_writer(link::event_topic());
  if (!plan) return tl::unexpected(plan.error());
  if (!scene) return tl::unexpected(scene.error());
  if (!heartbeat) return tl::unexpected(heartbeat.error());
  if (!command) return tl::unexpected(command.error());
  if (!status) return tl::unexpected(status.error());
  if (!event) return tl::unexpected(event.error());
  BusAccess access;
  access.participant = std::move(participant);
  access.readers = {std::move(*plan), std::move(*scene), std::move(*heartbeat),
                    std::move(*command)};
  access.status = std::move(*status);
  access.event = std::move(*event);
  return access;
}

void open_topic_channel(BusAccess& access, const LinkSpec& spec) {
  access.states = link::make_topic_channel(*access.participant,
                                           {.cell_size_m = spec.cell_size_m,
                                            .communication_radius_m = spec.communication_radius_m,
                                            .join_margin_m = spec.join_margin_m,
                                            .leave_margin_m = spec.leave_margin_m});
}

/// Opens the state channel that the run uses. A process behind the gateway always uses topics.
Result<BusAccess> join_bus(const ProcessOptions& options, const shell::RunInfo& run,
                           const Mission& mission) {
  const link::ReceptionFaults faults{
      .faults = options.faults,
      .seed = mix_seed(mix_seed(run.seed, kFaultSeed), options.number + 1),
      .run_began = run.began};
  auto participant = link::join_as_agent(link::meeting_of(run, faults), options.number,
                                         fmt::format("robot_agent_{}", options.first.value()),
                                         options.vendor, options.by_gateway);
  if (!participant) return tl::unexpected(participant.error());
  auto access = open_endpoints(std::move(*participant));
  if (!access) return access;
  access->run = static_cast<std::uint64_t>(run.began.time_since_epoch().count());
  // Topics do without multicast, and then the reliable command alone stops the robots.
  if (auto stops = link::StopReceiver::open(
          {.domain = run.domain, .interface = run.interface, .faults = faults})) {
    access->stops = std::move(*stops);
  }
  if (run.channel == Channel::kGroups && !options.by_gateway) {
    auto states = make_group_channel(mission.link, run, faults);
    if (!states) return tl::unexpected(states.error());
    access->states = std::move(*states);
  } else {
    open_topic_channel(*access, mission.link);
  }
  return access;
}

}  // namespace swarm::agent
