// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace swarm {

/// Starts to load memory into the cache while the caller computes something else.
inline void prefetch(const void* begin, std::size_t bytes) {
  constexpr std::size_t kLine = 64;
  const char* const at = static_cast<const char*>(begin);
  for (std::size_t i = 0; i < bytes; i += kLine) __builtin_prefetch(at + i);
  // Without a side effect that g++ sees, it treats the function as pure and removes its calls.
  asm volatile("");
}

}  // namespace swarm
