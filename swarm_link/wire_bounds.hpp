// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "swarm_link/messages.hpp"

/// Checks the bounds of a message's own sequences, from the list of its fields.
namespace swarm::link {

/// Whether every sequence of the message respects its bound; a writer refuses the message
/// otherwise. Texts are truncated instead: a shortened event is better than none. Elements of
/// sequences contain no sequences, so they need no check.
template <Message M>
bool fits_wire(const M& message) {
  return all_fields<M>([&](auto field) {
    using F = decltype(field);
    if constexpr (kIsSequence<typename F::Type>) {
      return (message.*F::kMember).size() <= F::kBound;
    } else {
      return true;
    }
  });
}

}  // namespace swarm::link
