// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

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
inline Float4 max(Float4 a, Float4 b) { return a > b ? a : b; }

/// The same number in every lane.
inline Float4 all(float v) { return Float4{v, v, v, v}; }
inline Int4 all(std::int32_t v) { return Int4{v, v, v, v}; }

}  // namespace swarm
