// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/run_clock.hpp"

#include <fstream>

#include "swarm_core/base/clock.hpp"

namespace swarm::shell {
namespace {

// Containers of one machine share it, as they share the steady clock.
std::string boot_id() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string id;
  std::getline(file, id);
  return id;
}

}  // namespace

RunClock own_clock() {
  return {.boot_id = boot_id(), .utc_minus_steady_ns = utc_offset_ns().load()};
}

bool follow(const RunClock& clock) {
  if (clock.boot_id.empty() || clock.boot_id != boot_id()) return false;
  utc_offset_ns() = clock.utc_minus_steady_ns;
  return true;
}

void follow(UtcTime theirs, SteadyTime then) {
  utc_offset_ns() = (theirs.time_since_epoch() - then.time_since_epoch()).count();
}

}  // namespace swarm::shell
