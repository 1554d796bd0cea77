// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/chaos_means.hpp"

#include <utility>

#include "experiments/chaos/small_disk.hpp"
#include "swarm_link/vendor.hpp"

namespace swarm::launcher {

ChaosMeans find_means(const std::filesystem::path& folder) {
  ChaosMeans means;
  const auto take = [&](auto& member, auto result, const char* fault) {
    if (result) {
      member = *std::move(result);
    } else {
      means.left_out[fault] = result.error().message;
    }
  };
  take(means.clock, SteppedClock::make(folder / "clock_offset"), "step-clock");
  take(means.hosts, HostPair::make(), "cut-hosts");
  if (const auto mounts = own_mounts(); mounts) {
    means.disks = true;
  } else {
    means.left_out["fill-disk"] = mounts.error().message;
  }
  means.gateways =
      link::built_with(link::Vendor::kFastDds) && link::built_with(link::Vendor::kCycloneDds);
  if (!means.gateways) means.left_out["gateways"] = "built with one DDS vendor";
  return means;
}

}  // namespace swarm::launcher
