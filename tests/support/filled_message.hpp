// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <type_traits>

#include "swarm_link/fields.hpp"

namespace swarm::testing {

/// Fills every field of a message with a value of its own; sequences get two elements.
class Filler {
 public:
  template <class T>
  void fill(T& value) {
    if constexpr (link::Message<T>) {
      link::for_each_field<T>([&](auto field) { fill(value.*decltype(field)::kMember); });
    } else if constexpr (link::kIsSequence<T>) {
      value.resize(2);
      for (auto& element : value) fill(element);
    } else if constexpr (link::kIsArray<T>) {
      for (auto& element : value) fill(element);
    } else if constexpr (link::kIsText<T>) {
      value = "text " + std::to_string(++count_);
    } else if constexpr (std::is_same_v<T, bool>) {
      value = ++count_ % 2 == 0;
    } else if constexpr (std::is_floating_point_v<T>) {
      value = static_cast<T>(0.25 * ++count_);
    } else {
      value = static_cast<T>(++count_ % 100);
    }
  }

 private:
  int count_ = 0;
};

template <link::Message M>
M filled_message() {
  M message;
  Filler().fill(message);
  return message;
}

}  // namespace swarm::testing
