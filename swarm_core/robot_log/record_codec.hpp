// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "swarm_core/robot_log/record.hpp"

/// Robot-log records as messages: plain CDR of the structs of idl/blackbox.idl, little-endian.
namespace swarm::robot_log {

/// Most bytes of a note's code and of its text, and most refusal counters; the rest is cut off.
inline constexpr std::size_t kMaxNoteText = 4096;
inline constexpr std::size_t kMaxRefusals = 255;

/// Kinds of records, by their index in Record: topic and schema of each.
struct Kind {
  std::string_view topic;
  std::string_view type;
  std::vector<std::string_view> structs;  ///< of idl/blackbox.idl
};
/// All kinds, by index in Record.
const std::array<Kind, std::variant_size_v<Record>>& kinds();

/// Replaces `out` by the message that encodes this record of a robot.
void encode(RobotId robot, const Record& record, std::vector<unsigned char>& out);

/// A record and the robot that it belongs to.
struct RobotRecord {
  RobotId robot{};
  Record record{};
};

/// The record, or nothing if the message is malformed or holds numbers that are not finite.
std::optional<RobotRecord> decode(std::size_t kind, std::span<const unsigned char> message);

/// The time of a record.
inline UtcTime stamp_of(const Record& record) {
  return std::visit([](const auto& r) { return r.stamp; }, record);
}

}  // namespace swarm::robot_log
