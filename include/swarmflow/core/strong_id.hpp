// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstddef>
#include <functional>

namespace swarm {

/// An integer that cannot be mistaken for another kind of integer: explicit construction, ordered,
/// hashable, no arithmetic, no implicit conversion.
template <class Tag, class Rep>
class StrongId {
 public:
  constexpr StrongId() = default;
  constexpr explicit StrongId(Rep value) : value_(value) {}
  constexpr Rep value() const { return value_; }
  constexpr auto operator<=>(const StrongId&) const = default;

 private:
  Rep value_{};
};

}  // namespace swarm

template <class Tag, class Rep>
struct std::hash<swarm::StrongId<Tag, Rep>> {
  std::size_t operator()(swarm::StrongId<Tag, Rep> id) const noexcept {
    return std::hash<Rep>{}(id.value());
  }
};
