// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

#include "swarmflow/core/time.hpp"

namespace swarm {

/// A tick that begins later than this after its time is late.
constexpr Duration kLateTick = std::chrono::milliseconds(20);

/// How many ticks were late where one began `lateness` after the oldest that was due: every period
/// in between was missed. Without a period only the tick itself counts.
constexpr std::uint32_t late_ticks(Duration lateness, Duration period) {
  if (lateness <= kLateTick) return 0;
  if (period <= Duration::zero()) return 1;
  const auto missed = static_cast<std::uint32_t>(lateness / period);
  return missed + (lateness % period > kLateTick ? 1 : 0);
}

}  // namespace swarm
