// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace swarm {

/// A stamp on the wire may be any 64 bits. Stamps within this range [ns] have differences that fit
/// in 64 bits, too; UTC reaches its end in the year 2116.
inline constexpr std::int64_t kStampLimit_ns = (std::int64_t{1} << 62) - 1;

/// Whether a received stamp may be used in computations.
constexpr bool is_stamp(std::int64_t ns) { return -kStampLimit_ns <= ns && ns <= kStampLimit_ns; }

/// The nearest stamp that may be used in computations: for messages that are never refused.
constexpr std::int64_t to_stamp(std::int64_t ns) {
  return std::clamp(ns, -kStampLimit_ns, kStampLimit_ns);
}

}  // namespace swarm
