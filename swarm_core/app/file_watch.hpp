// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "swarm_core/app/file_thread.hpp"

namespace swarm::shell {

/// Codes of the events that a process sends about its files.
inline constexpr std::string_view kDiskFails = "disk-fails";
inline constexpr std::string_view kDiskWorks = "disk-works";
/// Something that was handed over to be written is missing: the evidence of the run is not whole.
inline constexpr std::string_view kRecordsLost = "records-lost";
/// Code of the launcher's event about the log of a dead or silent robot that ends before its last
/// step. Its text begins with "robot" and the robot's number.
inline constexpr std::string_view kLogIncomplete = "log-incomplete";

/// Turns the health of a process' files into events: one when writing begins to fail, one when it
/// works again, and one when something is lost for good. Not thread-safe.
class FileWatch {
 public:
  struct Event {
    bool is_warning = false;
    std::string_view code;
    std::string text;
  };
  /// An event, if something has changed since the last call. Allocates only for events.
  std::optional<Event> step(const FileHealth& health);

 private:
  bool fails_ = false;
  std::uint64_t lost_ = 0;
  std::uint32_t removed_ = 0;
};

}  // namespace swarm::shell
