// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace swarm {

/// Four numbers that are computed with at once, by the vectors that g++ and clang know on every
/// machine: + − · / and [] as one expects; a comparison gives −1 where it holds and 0 elsewhere,
/// and `mask ? a : b` picks.
using Float4 [[gnu::vector_size(16)]] = float;
using Int4 [[gnu::vector_size(16)]] = std::int32_t;
constexpr std::uint32_t kLanes = 4;

inline Float4 to_float(Int4 v) { return __builtin_convertvector(v, Float4); }
inline Int4 min(Int4 a, Int4 b) { return a < b ? a : b; }
inline Int4 max(Int4 a, Int4 b) { return a > b ? a : b; }
inline Float4 max(Float4 a, Float4 b) { return a > b ? a : b; }

inline Float4 all(float v) { return Float4{v, v, v, v}; }
inline Int4 all(std::int32_t v) { return Int4{v, v, v, v}; }

}  // namespace swarm
