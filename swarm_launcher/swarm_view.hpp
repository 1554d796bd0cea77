// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "swarm_core/base/time.hpp"
#include "swarm_link/messages.hpp"

namespace swarm::launcher {

/// What the robots' statuses say together, for the live line. Never part of an audit.
class SwarmView {
 public:
  SwarmView() = default;
  explicit SwarmView(std::uint32_t robots) : robots_(robots) {}

  void take(const link::StatusMessage& status);

  /// "gap 0.31 m  states 320/s sent 2210/s heard  late 0.0 %"; rates since the previous call.
  std::string describe(SteadyTime now);

 private:
  struct Totals {
    std::uint64_t sent = 0, heard = 0, ticks = 0, late = 0;
  };
  std::vector<link::StatusMessage> robots_;
  Totals before_;
  SteadyTime at_;
};

}  // namespace swarm::launcher
