// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace swarm::link {

/// DDS implementation of a process; the two interoperate.
enum class Vendor : std::uint8_t { kFastDds, kCycloneDds };

/// The name of a vendor on command lines.
constexpr std::string_view to_string(Vendor vendor) {
  return vendor == Vendor::kFastDds ? "fastdds" : "cyclonedds";
}

/// The vendor of that name, if there is one.
constexpr std::optional<Vendor> vendor_named(std::string_view name) {
  for (const Vendor vendor : {Vendor::kFastDds, Vendor::kCycloneDds}) {
    if (name == to_string(vendor)) return vendor;
  }
  return std::nullopt;
}

}  // namespace swarm::link
