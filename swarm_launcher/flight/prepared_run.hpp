// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "swarm_core/app/control_socket.hpp"
#include "swarm_core/app/file_thread.hpp"
#include "swarm_core/app/memory_file.hpp"
#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/app/shared_steps.hpp"
#include "swarm_launcher/flight/launcher_bus.hpp"
#include "swarm_launcher/flight/run_checks.hpp"
#include "swarm_launcher/flight/scene_keeper.hpp"
#include "swarm_launcher/hosts/remote_hosts.hpp"
#include "swarm_link/roles/domain_lock.hpp"
#include "swarm_link/roles/join.hpp"

namespace swarm::launcher {

/// A run that is ready to fly: options checked, DDS domain reserved, run directory made, bus
/// joined, control socket and port for other hosts open. No process has been started.
class PreparedRun {
 public:
  /// All errors that a user can cause come from here. What it reserved is released when it fails,
  /// except for the run directory.
  static Result<std::unique_ptr<PreparedRun>> make(FlightOptions options);

  const FlightOptions& options() const { return checked_.options; }
  const ChannelChoice& channel() const { return checked_.channel; }
  const std::filesystem::path& dir() const { return dir_; }
  /// As in `run.json`.
  const shell::RunInfo& info() const { return info_; }

  /// Writes the files of the run; no other thread waits for the disk.
  shell::FileThread& files() { return files_; }
  /// File with what planner and agents read first, see shell::read_run_inputs().
  std::string inputs() const { return inputs_->path(); }
  /// The last control steps of this host's robots.
  const shell::SharedSteps& steps() const { return *steps_; }
  LauncherBus& bus() { return *bus_; }
  SceneKeeper& scene() { return *scene_; }
  shell::ControlServer& control() { return *control_; }
  /// Null if all robots are on this host.
  RemoteHosts* hosts() { return hosts_ ? &*hosts_ : nullptr; }

 private:
  PreparedRun(CheckedRun checked, link::DomainLock lock, std::filesystem::path dir);
  /// Joins the bus.
  Result<void> join();
  /// Writes what the processes of the run read, into the run directory and into memory.
  Result<void> write_inputs();
  /// Listens for other hosts, if some robots are theirs.
  Result<void> open_to_hosts();

  CheckedRun checked_;
  link::DomainLock lock_;
  std::filesystem::path dir_;
  shell::RunInfo info_;
  shell::FileThread files_;
  std::optional<shell::MemoryFile> inputs_;
  std::optional<shell::SharedSteps> steps_;
  std::unique_ptr<link::DiscoveryServer> server_;  // none with static peers
  std::unique_ptr<link::Participant> participant_;
  std::optional<LauncherBus> bus_;
  std::optional<SceneKeeper> scene_;
  std::optional<shell::ControlServer> control_;
  std::optional<RemoteHosts> hosts_;
};

}  // namespace swarm::launcher
