// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace swarm::monitor {

static_assert(std::endian::native == std::endian::little);

/// Appends `size` bytes.
inline void append_bytes(std::vector<std::byte>& bytes, const void* from, std::size_t size) {
  const std::size_t at = bytes.size();
  bytes.resize(at + size);
  if (size > 0) std::memcpy(bytes.data() + at, from, size);
}

/// Appends a number as it lies in memory here: little-endian.
template <class T>
void append_raw(std::vector<std::byte>& bytes, T value) {
  static_assert(std::is_arithmetic_v<T>);
  append_bytes(bytes, &value, sizeof(T));
}

/// Plain CDR, little-endian: every number at a multiple of its size after the encapsulation.
class CdrWriter {
 public:
  CdrWriter() : bytes_{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}} {}

  /// Pads to the alignment of T, counted from the end of the encapsulation header, then appends.
  template <class T>
  void put(T value) {
    while ((bytes_.size() - kHeader) % sizeof(T) != 0) bytes_.push_back(std::byte{0});
    append_raw(bytes_, value);
  }
  void put_bool(bool value) { put(static_cast<std::uint8_t>(value)); }
  /// Lengths of sequences and strings are 32-bit; a string's length counts its final zero.
  void put_length(std::size_t length) { put(static_cast<std::uint32_t>(length)); }
  void put_string(std::string_view text) {
    put_length(text.size() + 1);
    append_bytes(bytes_, text.data(), text.size());
    bytes_.push_back(std::byte{0});
  }

  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  static constexpr std::size_t kHeader = 4;
  std::vector<std::byte> bytes_;
};

}  // namespace swarm::monitor
