// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstddef>
#include <functional>

namespace swarm {

/// An integer that cannot be mistaken for another kind of integer: explicit construction, ordered,
/// hashable, no arithmetic, no implicit conversion. As cheap as a Rep.
/// \tparam Tag any type, only to distinguish ids: `StrongId<struct RobotIdTag, std::uint32_t>`
/// \tparam Rep the integer that is stored
template <class Tag, class Rep>
class StrongId {
 public:
  /// The id 0.
  constexpr StrongId() = default;
  /// The id with this number.
  constexpr explicit StrongId(Rep value) : value_(value) {}
  /// The stored number, for arrays and messages.
  constexpr Rep value() const { return value_; }
  /// Ordered by number; also gives ==.
  constexpr auto operator<=>(const StrongId&) const = default;

 private:
  Rep value_{};
};

}  // namespace swarm

/// Hash of an id, for std::unordered_map and std::unordered_set: that of its number.
template <class Tag, class Rep>
struct std::hash<swarm::StrongId<Tag, Rep>> {
  /// The hash of the id's number.
  std::size_t operator()(swarm::StrongId<Tag, Rep> id) const noexcept {
    return std::hash<Rep>{}(id.value());
  }
};
