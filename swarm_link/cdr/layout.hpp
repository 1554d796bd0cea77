// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "swarm_link/fields.hpp"

/// Sizes of values in plain CDR (XCDR1): a number is aligned to its own size, counted from the end
/// of the encapsulation; a length precedes each sequence and text.
namespace swarm::link::cdr {

/// Two bytes of representation identifier (byte order), two of options.
inline constexpr std::size_t kEncapsulationBytes = 4;
/// Of the length before a sequence or text.
inline constexpr std::size_t kLengthBytes = sizeof(std::uint32_t);

/// Rounds up to a multiple of `size`, a power of two.
constexpr std::size_t aligned(std::size_t at, std::size_t size) {
  return (at + size - 1) & ~(size - 1);
}

/// Fewest bytes of a T. A received sequence length is checked against it before memory is
/// allocated.
template <class T>
constexpr std::size_t least_bytes() {
  if constexpr (Message<T>) {
    std::size_t sum = 0;
    for_each_field<T>([&](auto field) { sum += least_bytes<typename decltype(field)::Type>(); });
    return sum;
  } else if constexpr (kIsSequence<T> || kIsText<T>) {
    return kLengthBytes;
  } else if constexpr (kIsArray<T>) {
    return std::tuple_size_v<T> * least_bytes<typename T::value_type>();
  } else {
    return sizeof(T);
  }
}

/// End of a T that begins at `at`, with sequences and texts as long as their bounds.
template <class T, std::size_t Bound = 0>
constexpr std::size_t most_end(std::size_t at);

/// Most bytes of a T over all alignments of its beginning (the largest alignment is 8).
template <class T, std::size_t Bound = 0>
constexpr std::size_t most_bytes() {
  std::size_t most = 0;
  for (std::size_t begin = 0; begin < 8; ++begin) {
    most = std::max(most, most_end<T, Bound>(begin) - begin);
  }
  return most;
}

/// Elements of a sequence are counted with their worst alignment, so the result is an upper bound,
/// not always exact.
template <class T, std::size_t Bound>
constexpr std::size_t most_end(std::size_t at) {
  if constexpr (Message<T>) {
    for_each_field<T>([&](auto field) {
      using F = decltype(field);
      at = most_end<typename F::Type, F::kBound>(at);
    });
    return at;
  } else if constexpr (kIsSequence<T>) {
    return aligned(at, kLengthBytes) + kLengthBytes + Bound * most_bytes<typename T::value_type>();
  } else if constexpr (kIsText<T>) {
    return aligned(at, kLengthBytes) + kLengthBytes + Bound + 1;
  } else if constexpr (kIsArray<T>) {
    return at + std::tuple_size_v<T> * most_bytes<typename T::value_type>();
  } else {
    return aligned(at, sizeof(T)) + sizeof(T);
  }
}

}  // namespace swarm::link::cdr
