// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/prepared_run.hpp"

#include <utility>

#include "swarm_core/app/run_dir.hpp"
#include "swarm_core/base/clock.hpp"
#include "swarm_link/roles/run_meeting.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {

PreparedRun::PreparedRun(CheckedRun checked, link::DomainLock lock, std::filesystem::path dir)
    : checked_(std::move(checked)), lock_(std::move(lock)), dir_(std::move(dir)) {}

// First everything that may be refused without side effects, then the domain, the run directory and
// the bus.
Result<std::unique_ptr<PreparedRun>> PreparedRun::make(FlightOptions options) {
  const RunAbilities abilities = abilities_of(options);
  auto checked = check_run(std::move(options), abilities);
  if (!checked) return tl::unexpected(checked.error());
  const FlightOptions& o = checked->options;
  auto lock = link::DomainLock::take(
      o.how.domain, link::participants_for({.relays = checked->relays}, o.agents()));
  if (!lock) return tl::unexpected(lock.error());
  auto dir = shell::make_run_dir(o.how.out, o.mission.name);
  if (!dir) return tl::unexpected(dir.error());
  if (auto written = shell::write_file(*dir / shell::kMissionFile, to_yaml(o.mission)); !written) {
    return tl::unexpected(written.error());
  }
  auto run = std::unique_ptr<PreparedRun>(
      new PreparedRun(std::move(*checked), std::move(*lock), std::move(*dir)));
  if (const auto joined = run->join(); !joined) return tl::unexpected(joined.error());
  auto control = shell::ControlServer::listen(run->dir_);
  if (!control) return tl::unexpected(control.error());
  run->control_.emplace(std::move(*control));
  if (const auto open = run->open_to_hosts(); !open) return tl::unexpected(open.error());
  return run;
}

// The run information is written before any process starts, because processes read from it how to
// join.
Result<void> PreparedRun::join() {
  const auto& [mission, per_process, how] = checked_.options;
  link::DiscoveryAddress discovery;
  if (checked_.relays == 0) {
    auto server = link::make_discovery_server(lock_.domain(), 0);
    if (!server) return tl::unexpected(server.error());
    server_ = std::move(*server);
    discovery = server_->address();
  }
  info_ = {.domain = lock_.domain(),
           .discovery_host = discovery.host,
           .discovery_port = discovery.port,
           .agents = checked_.options.agents(),
           .relays = checked_.relays,
           .launcher = how.dds.launcher,
           .planner = how.dds.planner,
           .host = how.interface,
           .interface = how.interface,
           .channel = checked_.channel.channel,
           .seed = how.seed,
           .began = utc_now()};
  if (auto written = shell::write_run_info(dir_, info_); !written) return written;
  auto participant = link::join_as_launcher(link::meeting_of(info_));
  if (!participant) return tl::unexpected(participant.error());
  participant_ = std::move(*participant);
  auto bus = open_launcher_bus(*participant_, link::wire_limits(mission));
  if (!bus) return tl::unexpected(bus.error());
  bus_.emplace(std::move(*bus));
  scene_.emplace(mission.world, dir_, std::move(bus_->scenes));
  return {};
}

// The last robots are those of other hosts, so that the local processes have the first indices.
Result<void> PreparedRun::open_to_hosts() {
  const auto& [mission, per_process, how] = checked_.options;
  if (how.remote == 0) return {};
  auto server = LineServer::listen({how.interface, how.join_port});
  if (!server) return tl::unexpected(server.error());
  const std::uint32_t first = mission.robots.count - how.remote;
  hosts_.emplace(std::move(*server),
                 HostOffer{.run = info_,
                           .first_robot = first,
                           .robots = how.remote,
                           .per_process = per_process,
                           .first_process = first / per_process,
                           .fault = how.fault,
                           .mission_yaml = to_yaml(mission)},
                 mission.link.status_hz, dir_, how.join_token);
  return {};
}

}  // namespace swarm::launcher
