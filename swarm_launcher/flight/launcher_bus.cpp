// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/launcher_bus.hpp"

#include <utility>

#include "swarm_link/monitor_topics.hpp"

namespace swarm::launcher {

Result<LauncherBus> open_launcher_bus(link::Participant& participant,
                                      const link::WireLimits& limits) {
  auto statuses = participant.make_reader(link::status_topic());
  auto events = participant.make_reader(link::event_topic());
  auto heartbeats = participant.make_reader(link::heartbeat_topic());
  auto commands = participant.make_writer(link::command_topic());
  auto scenes = participant.make_writer(link::scene_topic());
  auto status_relay = participant.make_writer(link::relayed_status_topic());
  auto event_relay = participant.make_writer(link::relayed_event_topic());
  if (!statuses) return tl::unexpected(statuses.error());
  if (!events) return tl::unexpected(events.error());
  if (!heartbeats) return tl::unexpected(heartbeats.error());
  if (!commands) return tl::unexpected(commands.error());
  if (!scenes) return tl::unexpected(scenes.error());
  if (!status_relay) return tl::unexpected(status_relay.error());
  if (!event_relay) return tl::unexpected(event_relay.error());
  return LauncherBus{
      .participant = &participant,
      .inbox =
          HealthInbox({std::move(*statuses), std::move(*events), std::move(*heartbeats)}, limits),
      .commands = std::move(*commands),
      .scenes = std::move(*scenes),
      .status_relay = std::move(*status_relay),
      .event_relay = std::move(*event_relay)};
}

}  // namespace swarm::launcher
