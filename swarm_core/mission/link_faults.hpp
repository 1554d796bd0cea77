// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm {

/// A bad network: what it does to each message of each receiver independently.
struct LinkFaults {
  double loss = 0.0;  ///< share that never arrives
  Duration delay{};
  Duration jitter{};  ///< each message comes up to this much earlier or later than `delay`
  Duration from{};    ///< since the run began
  Duration until = Duration::max();

  bool any() const { return loss > 0.0 || delay > Duration::zero() || jitter > Duration::zero(); }
  bool at(Duration since_begin) const { return since_begin >= from && since_begin < until; }
};

/// Reads `loss=0.2,delay-ms=150,jitter-ms=50,from=10,to=60`: every key may be left out, times since
/// the run began are in seconds. Fails (kBadInput) with what is allowed.
Result<LinkFaults> parse_link_faults(std::string_view text);

/// What becomes of a message: how much later than it was sent it arrives, or nothing if it is lost.
/// A function of the two numbers alone.
std::optional<Duration> fate(const LinkFaults& faults, std::uint64_t seed, std::uint64_t message);

}  // namespace swarm
