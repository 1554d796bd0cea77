// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/prepared_run.hpp"

#include <cstddef>
#include <string_view>
#include <utility>

#include "swarm_core/app/run_dir.hpp"
#include "swarm_core/app/run_inputs.hpp"
#include "swarm_core/base/clock.hpp"
#include "swarm_core/mission/link_faults.hpp"
#include "swarm_link/roles/run_meeting.hpp"
#include "swarmflow/core/random.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

// Thousands of changes of the scene that wait for the disk.
constexpr std::size_t kSceneBytes = 1U << 20U;

/// The simulated network faults of what the launcher itself receives.
link::ReceptionFaults own_faults(const shell::RunInfo& run, const std::string& fault) {
  constexpr std::uint64_t kSeed = 0x1A2C;  // own random numbers for the link
  const auto faults = parse_link_faults(fault);
  if (!faults || !faults->at_launcher) return {};
  return {.faults = *faults, .seed = mix_seed(run.seed, kSeed), .run_began = run.began};
}

}  // namespace

PreparedRun::PreparedRun(CheckedRun checked, link::DomainLock lock, std::filesystem::path dir)
    : checked_(std::move(checked)), lock_(std::move(lock)), dir_(std::move(dir)) {}

// First everything that may be refused without side effects, then the domain, the run directory and
// the bus.
Result<std::unique_ptr<PreparedRun>> PreparedRun::make(FlightOptions options) {
  const RunAbilities abilities = abilities_of(options);
  auto checked = check_run(std::move(options), abilities);
  if (!checked) return tl::unexpected(checked.error());
  const FlightOptions& o = checked->options;
  const link::Meeting meeting{.relays = checked->relays};
  auto lock = link::DomainLock::take(o.how.domain,
                                     {.participants = link::participants_for(meeting, o.agents()),
                                      .fixed = link::fixed_participants(meeting)});
  if (!lock) return tl::unexpected(lock.error());
  auto dir = shell::make_run_dir(o.how.out, o.mission.name);
  if (!dir) return tl::unexpected(dir.error());
  auto run = std::unique_ptr<PreparedRun>(
      new PreparedRun(std::move(*checked), std::move(*lock), std::move(*dir)));
  if (const auto joined = run->join(); !joined) return tl::unexpected(joined.error());
  auto control = shell::ControlServer::listen(run->dir_);
  if (!control) return tl::unexpected(control.error());
  run->control_.emplace(std::move(*control));
  if (const auto open = run->open_to_hosts(); !open) return tl::unexpected(open.error());
  return run;
}

// The inputs are written before any process starts, because processes read from them how to join.
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
           .began = utc_now(),
           .clock = shell::own_clock()};
  if (auto written = write_inputs(); !written) return written;
  auto participant = link::join_as_launcher(link::meeting_of(info_, own_faults(info_, how.fault)));
  if (!participant) return tl::unexpected(participant.error());
  participant_ = std::move(*participant);
  auto bus = open_launcher_bus(*participant_, link::wire_limits(mission));
  if (!bus) return tl::unexpected(bus.error());
  bus_.emplace(std::move(*bus));
  auto log = files_.append_to(files::lines_of(dir_ / shell::kSceneFile), shell::Flush::kAtOnce,
                              kSceneBytes);
  scene_.emplace(
      mission.world, [log](std::string_view line) mutable { log.push(line); },
      std::move(bus_->scenes));
  return {};
}

// The files are written here for the first time, so that a directory that cannot be written is
// refused. The thread writes them again if others remove them.
Result<void> PreparedRun::write_inputs() {
  const std::string mission = to_yaml(checked_.options.mission);
  const std::string run = shell::to_json(info_);
  for (const auto& [name, text] :
       {std::pair{shell::kMissionFile, mission}, {shell::kRunFile, run}}) {
    if (auto written = shell::write_file(dir_ / name, text); !written) return written;
    files_.keep(dir_ / name, text);
  }
  auto inputs = shell::MemoryFile::make("swarmflow-inputs", shell::to_json(info_, mission));
  if (!inputs) return tl::unexpected(inputs.error());
  inputs_.emplace(*std::move(inputs));
  const std::uint32_t here = checked_.options.mission.robots.count - checked_.options.how.remote;
  auto steps = shell::SharedSteps::make(RobotId(0), here);
  if (!steps) return tl::unexpected(steps.error());
  steps_.emplace(*std::move(steps));
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
                 HostTimes{.status_hz = mission.link.status_hz,
                           .quorum_timeout_s = mission.launcher.quorum_timeout_s},
                 dir_, how.join_token);
  return {};
}

}  // namespace swarm::launcher
