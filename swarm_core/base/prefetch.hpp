// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace swarm {

/// Asks for memory to be in the cache soon, while something else is computed.
inline void prefetch(const void* begin, std::size_t bytes) {
  constexpr std::size_t kLine = 64;
  const char* const at = static_cast<const char*>(begin);
  for (std::size_t i = 0; i < bytes; i += kLine) __builtin_prefetch(at + i);
  // Without an effect that g++ knows, it takes the function for pure and drops its calls.
  asm volatile("");
}

}  // namespace swarm
