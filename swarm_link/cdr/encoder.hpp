// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <vector>

#include "swarm_link/cdr/layout.hpp"

namespace swarm::link::cdr {

/// The part of a text that is sent: up to its bound, and up to its first zero byte, which ends a
/// text in CDR.
inline std::string_view travelling(std::string_view text, std::size_t bound) {
  text = text.substr(0, bound);
  return text.substr(0, text.find('\0'));
}

/// Upper bound of the encoded size of a message with its present sequence lengths, which may exceed
/// their bounds.
template <Message M>
std::size_t room_for(const M& message) {
  std::size_t room = 0;
  for_each_field<M>([&](auto field) {
    using F = decltype(field);
    using T = typename F::Type;
    if constexpr (!Message<T> || !contains_sequence<T>()) {
      room += most_bytes < T, kIsText<T> ? F::kBound : 0 > ();  // of a sequence: its length
    } else {
      room += room_for(message.*F::kMember);
    }
    if constexpr (kIsSequence<T>) {
      using E = typename T::value_type;
      static_assert(!kIsSequence<E> && !kIsText<E>);
      if constexpr (contains_sequence<E>()) {
        for (const E& element : message.*F::kMember) room += room_for(element);
      } else {
        room += (message.*F::kMember).size() * most_bytes<E>();
      }
    }
  });
  return room;
}

/// Writes values at the positions that CDR prescribes, in the byte order of this machine. It does
/// not check the buffer: the caller provides room_for() + kSlack bytes.
class Encoder {
 public:
  /// Padding is cleared with one store of the size of the number that follows, so a write may touch
  /// up to this many bytes beyond the value.
  static constexpr std::size_t kSlack = 8;

  explicit Encoder(std::byte* begin) : begin_(begin) {}
  /// Bytes written, without the encapsulation.
  std::size_t size() const { return at_; }

  /// Appends one value: a message field by field, a sequence or text after its length. `Bound`
  /// truncates a text; a sequence must respect its bound already (fits_wire()).
  template <std::size_t Bound = 0, class T>
  void put(const T& value) {
    if constexpr (Message<T>) {
      for_each_field<T>([&](auto field) {
        using F = decltype(field);
        put<F::kBound>(value.*F::kMember);
      });
    } else if constexpr (kIsSequence<T>) {
      put(static_cast<std::uint32_t>(value.size()));
      for (const auto& element : value) put(element);
    } else if constexpr (kIsArray<T>) {
      for (const auto& element : value) put(element);
    } else if constexpr (kIsText<T>) {
      put_text(travelling(value, Bound));
    } else {
      static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
      if constexpr (sizeof(T) > 1) {
        std::memset(begin_ + at_, 0, sizeof(T));
        at_ = aligned(at_, sizeof(T));
      }
      std::memcpy(begin_ + at_, &value, sizeof(T));
      at_ += sizeof(T);
    }
  }

 private:
  /// The length of a text in CDR includes the zero byte at its end.
  void put_text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    std::memcpy(begin_ + at_, text.data(), text.size());
    at_ += text.size();
    begin_[at_++] = std::byte{0};
  }

  std::byte* begin_;    ///< of the caller, after the encapsulation
  std::size_t at_ = 0;  ///< bytes written
};

}  // namespace swarm::link::cdr
