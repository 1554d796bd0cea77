// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "swarm_link/messages.hpp"

/// Checks the bounds of a message's own sequences, from the list of its fields.
namespace swarm::link {

/// Whether every sequence of the message respects its bound; a writer refuses the message
/// otherwise. Texts are truncated instead: a shortened event is better than none.
template <Message M>
bool fits_wire(const M& message) {
  return all_fields<M>([&](auto field) {
    using F = decltype(field);
    using T = typename F::Type;
    const auto& value = message.*F::kMember;
    if constexpr (kIsSequence<T>) {
      if (value.size() > F::kBound) return false;
      if constexpr (contains_sequence<typename T::value_type>()) {
        for (const auto& element : value) {
          if (!fits_wire(element)) return false;
        }
      }
    } else if constexpr (contains_sequence<T>()) {
      return fits_wire(value);
    }
    return true;
  });
}

}  // namespace swarm::link
