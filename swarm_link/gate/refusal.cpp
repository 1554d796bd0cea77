// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/gate/refusal.hpp"

#include <numeric>

namespace swarm::link {

// These names appear in the event texts of agents and planner.
std::string_view to_string(RefusalReason reason) {
  switch (reason) {
    case RefusalReason::kUndecodable:
      return "undecodable";
    case RefusalReason::kSchema:
      return "schema";
    case RefusalReason::kOversized:
      return "oversized";
    case RefusalReason::kNotFinite:
      return "not-finite";
    case RefusalReason::kOutOfRange:
      return "out-of-range";
    case RefusalReason::kBadGaussian:
      return "bad-gaussian";
    case RefusalReason::kBadMass:
      return "bad-mass";
    case RefusalReason::kStale:
      return "stale";
    case RefusalReason::kDuplicate:
      return "duplicate";
    case RefusalReason::kClockSkew:
      return "clock-skew";
    case RefusalReason::kForged:
      return "forged";
    case RefusalReason::kCount:
      break;
  }
  return "unknown";
}

std::uint64_t RefusalCounters::total() const {
  return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
}

}  // namespace swarm::link
