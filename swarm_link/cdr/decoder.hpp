// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "swarm_link/cdr/layout.hpp"

namespace swarm::link::cdr {

/// Reads what an Encoder of either byte order wrote. Nothing in the bytes is trusted: every value
/// must lie within them, and a sequence is allocated only if its elements could fit into the
/// remaining bytes, so that one corrupt length cannot exhaust memory. Sequence bounds are checked
/// by the Gate, which counts such messages by reason.
template <bool Swap>
class Decoder {
 public:
  explicit Decoder(std::span<const std::byte> bytes) : begin_(bytes.data()), size_(bytes.size()) {}

  /// Reads one value and advances. False when the bytes do not contain such a value; `value` and
  /// the position are then unspecified. `Bound`: of a text. A bool must be 0 or 1, since any other
  /// byte would be undefined behaviour in C++.
  template <std::size_t Bound = 0, class T>
  bool get(T& value) {
    if constexpr (Message<T>) {
      return all_fields<T>([&](auto field) {
        using F = decltype(field);
        return get<F::kBound>(value.*F::kMember);
      });
    } else if constexpr (kIsSequence<T>) {
      return get_sequence(value);
    } else if constexpr (kIsArray<T>) {
      return std::all_of(value.begin(), value.end(), [this](auto& e) { return get(e); });
    } else if constexpr (kIsText<T>) {
      return get_text(value, Bound);
    } else if constexpr (std::is_same_v<T, bool>) {
      std::uint8_t byte = 0;
      if (!get(byte) || byte > 1) return false;
      value = byte == 1;
      return true;
    } else {
      return get_number(value);
    }
  }

 private:
  /// Numbers are aligned to their own size, counted from the end of the encapsulation. memcpy,
  /// because the buffer itself need not be aligned. Enumerations are not range-checked here; the
  /// content checks do that.
  template <class T>
  bool get_number(T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    const std::size_t at = aligned(at_, sizeof(T));
    if (at > size_ || size_ - at < sizeof(T)) return false;
    if constexpr (Swap && sizeof(T) > 1) {
      std::array<std::byte, sizeof(T)> bytes;
      std::reverse_copy(begin_ + at, begin_ + at + sizeof(T), bytes.begin());
      std::memcpy(&value, bytes.data(), sizeof(T));
    } else {
      std::memcpy(&value, begin_ + at, sizeof(T));
    }
    at_ = at + sizeof(T);
    return true;
  }

  /// Reads a length and the elements. The length is compared with the number of elements that could
  /// fit into the remaining bytes before memory is allocated.
  template <class T>
  bool get_sequence(std::vector<T>& elements) {
    std::uint32_t length = 0;
    if (!get(length) || length > (size_ - at_) / least_bytes<T>()) return false;
    elements.resize(length);
    return std::all_of(elements.begin(), elements.end(), [this](T& e) { return get(e); });
  }

  /// A text that is longer than its bound, or contains a zero byte, is truncated, as the encoder
  /// does; the following fields are read from the correct position all the same.
  bool get_text(std::string& text, std::size_t bound) {
    std::uint32_t length = 0;
    if (!get(length) || length > size_ - at_) return false;
    const std::string_view all(reinterpret_cast<const char*>(begin_ + at_), length);
    text = all.substr(0, std::min(bound, all.find('\0')));
    at_ += length;
    return true;
  }

  const std::byte* begin_;  ///< after the encapsulation
  std::size_t size_;
  std::size_t at_ = 0;  ///< bytes read
};

}  // namespace swarm::link::cdr
