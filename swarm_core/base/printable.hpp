// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

/// Text of other processes, hosts and files ends in logs and terminals, where control characters
/// and directions of writing could forge what a reader sees.
namespace swarm {

/// Length in bytes of the character that a text begins with if it is well-formed UTF-8 and neither
/// controls a terminal nor reorders the text around it; 0 otherwise. \pre the text is not empty
inline std::size_t printable_character(std::string_view text) {
  const auto byte = [text](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return first >= 0x20 && first != 0x7F ? 1 : 0;  // C0 and delete
  const std::size_t length = first < 0xC2   ? 0
                             : first < 0xE0 ? 2
                             : first < 0xF0 ? 3
                             : first < 0xF5 ? 4
                                            : 0;
  if (length == 0) return 0;
  unsigned code = first & (0x7FU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return 0;
    code = code << 6U | (byte(i) & 0x3FU);
  }
  const bool is_overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x1'0000);
  const bool is_none = (code >= 0xD800 && code < 0xE000) || code > 0x10'FFFF;
  const bool controls = code < 0xA0;                                          // C1
  const bool reorders = code == 0x61C || code == 0x200E || code == 0x200F ||  // direction marks
                        (code >= 0x2028 && code <= 0x202E) ||  // separators, embeddings
                        (code >= 0x2066 && code <= 0x2069);    // isolates
  return is_overlong || is_none || controls || reorders ? 0 : length;
}

/// Whether a text consists of printable characters.
inline bool is_printable(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = printable_character(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

/// The text with '?' for every byte that belongs to no printable character.
inline std::string printable(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = printable_character(text);
    result += length == 0 ? "?" : text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return result;
}

}  // namespace swarm
