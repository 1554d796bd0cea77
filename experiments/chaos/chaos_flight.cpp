// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/chaos_flight.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "experiments/chaos/fault_injector.hpp"
#include "experiments/chaos/flight_processes.hpp"
#include "experiments/chaos/small_disk.hpp"
#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_launcher/processes/child_process.hpp"

namespace swarm::launcher {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(20);
constexpr Duration kLongest = std::chrono::minutes(10);
constexpr Duration kEnding = std::chrono::seconds(30);  ///< of a flight that is to end
constexpr std::uint16_t kJoinPort = 7000;               // the network is the flight's own

SteadyTime now() { return std::chrono::steady_clock::now(); }

class ChaosFlight {
 public:
  ChaosFlight(const ChaosFlightSpec& spec, const ChaosMeans& means) : spec_(spec), means_(means) {}

  Result<DisturbedFlight> fly() {
    if (auto started = start(); !started) return tl::unexpected(started.error());
    FaultInjector faults(spec_.faults, {.run_dir = spec_.dir,
                                        .parents = parents_,
                                        .bounds_m = spec_.bounds_m,
                                        .clock = means_.clock.get(),
                                        .hosts = hosts(),
                                        .disk = disk_.get()});
    const SteadyTime latest = now() + kLongest;
    std::optional<SteadyTime> mission_began, ending;
    while (!has_ended()) {
      std::this_thread::sleep_for(kStep);
      if (!mission_began && mission_has_started()) mission_began = now();
      const Duration mission_time = mission_began ? now() - *mission_began : Duration::zero();
      if (mission_began && !ending) faults.play(mission_time);
      if (!ending && (launcher_ended_ || shell::stop_requests() > 0)) {
        faults.undo_all(mission_time);
        if (!launcher_ended_) ::kill(parents_.launcher, SIGINT);
        ending = now();
      }
      const bool at_once = shell::stop_requests() > 1 || (ending && now() - *ending > kEnding);
      if (at_once || now() > latest) kill_all(parents_);
    }
    faults.undo_all(Duration::zero());
    return DisturbedFlight{.injected = faults.injected(),
                           .interrupted = shell::stop_requests() > 0};
  }

 private:
  HostPair* hosts() const { return spec_.setup.two_hosts ? means_.hosts.get() : nullptr; }

  // A small disk only for a flight that fills it.
  Result<void> start() {
    const bool fills = std::any_of(spec_.faults.begin(), spec_.faults.end(),
                                   [](const Fault& f) { return f.kind == FaultKind::kFillDisk; });
    if (means_.disks && fills) {
      auto disk = SmallDisk::make(spec_.dir, (16ULL + spec_.robots) << 20U);
      if (!disk) return tl::unexpected(disk.error());
      disk_ = *std::move(disk);
    }
    const auto log = spec_.dir.string() + ".log";
    const auto launcher = hosts() != nullptr
                              ? hosts()->start(HostPair::Host::kFirst, launcher_line(), log)
                              : start_process(launcher_line(), log);
    if (!launcher) return tl::unexpected(launcher.error());
    parents_.launcher = *launcher;
    if (hosts() == nullptr) return {};
    if (auto joined = join(log); !joined) {
      kill_all(parents_);
      return joined;
    }
    return {};
  }

  std::vector<std::string> launcher_line() const {
    std::vector<std::string> line = {sibling_program("swarm_launcher"),
                                     "run",
                                     spec_.mission.string(),
                                     "--out",
                                     spec_.dir.string(),
                                     "--robots",
                                     fmt::format("{}", spec_.robots),
                                     "--seed",
                                     fmt::format("{}", spec_.seed),
                                     "--per-process",
                                     "1",
                                     "--json"};
    const auto add = [&](std::vector<std::string> more) {
      line.insert(line.end(), more.begin(), more.end());
    };
    if (!spec_.setup.network.empty()) add({"--fault", spec_.setup.network});
    if (spec_.setup.gateway) add({"--channel", "groups", "--by-gateway", "2"});
    if (hosts() != nullptr) {
      add({"--interface", HostPair::address(HostPair::Host::kFirst), "--remote",
           fmt::format("{}", spec_.robots / 2), "--join-port", fmt::format("{}", kJoinPort)});
    }
    return line;
  }

  // As soon as the launcher prints that others may join.
  Result<void> join(const std::filesystem::path& log) {
    while (!has_ended() && shell::stop_requests() == 0) {
      const auto text = shell::read_file(log, 1U << 20U);
      if (text && text->find("swarm_launcher join") != std::string::npos) break;
      std::this_thread::sleep_for(kStep);
    }
    if (launcher_ended_) return {};
    const auto host = fmt::format("{}:{}", HostPair::address(HostPair::Host::kFirst), kJoinPort);
    const auto joined = hosts()->start(
        HostPair::Host::kSecond,
        {sibling_program("swarm_launcher"), "join", host, "--robots",
         fmt::format("{}", spec_.robots / 2), "--out", spec_.dir.string() + ".joined"},
        spec_.dir.string() + ".joined.log");
    if (!joined) return tl::unexpected(joined.error());
    parents_.joined = *joined;
    return {};
  }

  bool has_ended() {
    while (const auto child = reap_child()) {
      if (child->pid == parents_.launcher) launcher_ended_ = true;
      if (child->pid == parents_.joined) parents_.joined = 0;
    }
    return launcher_ended_ && parents_.joined == 0;
  }

  bool mission_has_started() const {
    const auto events = shell::read_file(spec_.dir / shell::kEventsFile, 1U << 24U);
    return events && events->find("\"command\"") != std::string::npos;
  }

  const ChaosFlightSpec& spec_;
  const ChaosMeans& means_;
  std::unique_ptr<SmallDisk> disk_{};
  FlightParents parents_{};
  bool launcher_ended_ = false;
};

}  // namespace

Result<DisturbedFlight> fly_disturbed(const ChaosFlightSpec& spec, const ChaosMeans& means) {
  return ChaosFlight(spec, means).fly();
}

}  // namespace swarm::launcher
