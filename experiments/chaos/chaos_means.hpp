// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "experiments/chaos/host_pair.hpp"
#include "experiments/chaos/stepped_clock.hpp"

namespace swarm::launcher {

/// What this machine lets a chaos run do. A fault whose means are missing is drawn and left out, so
/// that a seed is the same schedule with and without root.
struct ChaosMeans {
  std::unique_ptr<SteppedClock> clock{};          ///< empty: no clock is set
  std::unique_ptr<HostPair> hosts{};              ///< empty: all robots are on one host
  bool disks = false;                             ///< a disk can be filled
  bool gateways = false;                          ///< built with both DDS vendors
  std::map<std::string, std::string> left_out{};  ///< what is left out, and why
};

/// Tries all of them. `folder` is for files of this run. Call it from the main thread, before
/// any child is started.
ChaosMeans find_means(const std::filesystem::path& folder);

}  // namespace swarm::launcher
