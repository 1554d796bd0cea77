// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace swarm::agent {

/// Longest text of a fault in bytes: with the robot's number before it, it fits into an event.
inline constexpr std::size_t kMaxFaultText = 400;

/// What other people's code reports about a fault, as an event can carry it: control characters
/// become spaces and a long text is cut. The receivers of an event refuse any other.
inline std::string fault_text(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  }
  if (text.size() > kMaxFaultText) text.replace(kMaxFaultText - 3, std::string::npos, "...");
  return text;
}

}  // namespace swarm::agent
