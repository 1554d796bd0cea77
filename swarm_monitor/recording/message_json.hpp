// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "swarm_core/robot_log/reader.hpp"

namespace swarm::monitor {

/// What print_messages() read.
struct PrintedMessages {
  mcap::Damage damage;
  std::uint64_t printed = 0;
  std::set<std::string> topics;  ///< of all messages, printed or not
};

/// Hands over every message of a recording as a line of JSON: topic, type, times, sequence number
/// and, as "data", its fields by their names in the IDL. 64-bit integers are texts, since many
/// readers take JSON numbers for doubles; a message that cannot be decoded has "data": null.
/// `topics` are prefixes; empty: all. Ends when `print` returns false.
Result<PrintedMessages> print_messages(const std::filesystem::path& file,
                                       const std::vector<std::string>& topics,
                                       const std::function<bool(const std::string&)>& print);

}  // namespace swarm::monitor
