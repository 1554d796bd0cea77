// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "swarm_link/messages.hpp"

/// The bounds of a message's own sequences and texts, from the list of its fields.
namespace swarm::link {

/// Whether every sequence respects its bound. A writer refuses the message otherwise; texts it cuts
/// instead: half a sentence is better than no event.
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
