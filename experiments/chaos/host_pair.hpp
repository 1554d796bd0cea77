// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <sys/types.h>

#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// Two hosts on this machine, each a network namespace, with a cable between them that can be
/// pulled. They disappear with this object and the processes on them, however those end.
class HostPair {
 public:
  enum class Host : unsigned char { kFirst, kSecond };

  /// kEnvironment without root or without iproute2. Call it from the main thread, as start().
  static Result<std::unique_ptr<HostPair>> make();
  ~HostPair();
  HostPair(const HostPair&) = delete;
  HostPair& operator=(const HostPair&) = delete;

  static std::string address(Host host) { return host == Host::kFirst ? "10.77.0.1" : "10.77.0.2"; }
  /// As start_process(), on one of the hosts.
  Result<pid_t> start(Host host, const std::vector<std::string>& command_line,
                      const std::filesystem::path& log) const;

  /// False if it is pulled already.
  bool pull_cable();
  void plug_cable();

 private:
  HostPair() = default;
  Result<void> set_up();
  /// Executes `ip` with these arguments on a host.
  bool ip(Host host, std::vector<std::string> arguments) const;
  bool wait_until_running() const;
  bool is_running(Host host) const;
  int at(Host host) const { return networks_[static_cast<std::size_t>(host)]; }

  int home_ = -1;               ///< network of this process
  int networks_[2] = {-1, -1};  ///< file descriptors
  bool is_pulled_ = false;
};

}  // namespace swarm::launcher
