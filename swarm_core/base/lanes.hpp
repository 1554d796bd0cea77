// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace swarm {

/// Four numbers in one SIMD register, by the vector extension of g++ and clang, which works on
/// every machine: + − · / and [] act lane by lane, a comparison gives −1 where it holds and 0
/// elsewhere, and `mask ? a : b` selects.
using Float4 [[gnu::vector_size(16)]] = float;
using Int4 [[gnu::vector_size(16)]] = std::int32_t;
/// Numbers in a vector.
constexpr std::uint32_t kLanes = 4;

/// Each lane converted; exact up to 2²⁴.
inline Float4 to_float(Int4 v) { return __builtin_convertvector(v, Float4); }
/// Smaller and larger number, lane by lane.
inline Int4 min(Int4 a, Int4 b) { return a < b ? a : b; }
inline Int4 max(Int4 a, Int4 b) { return a > b ? a : b; }
inline Float4 min(Float4 a, Float4 b) { return a < b ? a : b; }
inline Float4 max(Float4 a, Float4 b) { return a > b ? a : b; }

/// The same number in every lane.
inline Float4 all(float v) { return Float4{v, v, v, v}; }
inline Int4 all(std::int32_t v) { return Int4{v, v, v, v}; }

/// The kLanes numbers from an address on, aligned or not.
inline Float4 load(const float* from) {
  Float4 v;
  std::memcpy(&v, from, sizeof(v));
  return v;
}

/// Bit k is set if lane k of a mask is. The lanes of a mask are 0 or −1.
inline std::uint32_t bits_of(Int4 mask) {
#ifdef __SSE2__
  return static_cast<std::uint32_t>(_mm_movemask_ps(__builtin_bit_cast(Float4, mask)));
#else
  const Int4 bit = mask & Int4{1, 2, 4, 8};
  return static_cast<std::uint32_t>(bit[0] | bit[1] | bit[2] | bit[3]);
#endif
}

/// Writes `first` + k for each set bit k of four, ascending, and returns the end of what it wrote.
/// Without branches: it always stores kLanes numbers at `to`, of which those that count come first.
inline std::uint32_t* write_set(std::uint32_t bits, std::uint32_t first, std::uint32_t* to) {
  alignas(64) static constexpr std::array<std::array<std::uint32_t, kLanes>, 16> kSet{{
      {},
      {0},
      {1},
      {0, 1},
      {2},
      {0, 2},
      {1, 2},
      {0, 1, 2},
      {3},
      {0, 3},
      {1, 3},
      {0, 1, 3},
      {2, 3},
      {0, 2, 3},
      {1, 2, 3},
      {0, 1, 2, 3},
  }};
  constexpr std::uint64_t kCounts = 0x4332322132212110;  // of set bits, four bits for each number
  Int4 numbers;
  std::memcpy(&numbers, kSet[bits].data(), sizeof(numbers));
  numbers += all(static_cast<std::int32_t>(first));
  std::memcpy(to, &numbers, sizeof(numbers));
  return to + (kCounts >> (4 * bits) & 0xF);
}

}  // namespace swarm
