// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>

#include "swarm_core/robot_log/format.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::mcap {

/// What was wrong with a file that was read.
struct Damage {
  std::uint64_t damaged = 0;  ///< number of damaged places; reading continues after each of them
  bool truncated = false;     ///< the file ends inside a record: its writer was killed
  bool ended = false;         ///< the file has an end record: its writer finished
};

/// The functions that read() calls with the content of a file; each may be empty. A message is
/// passed with its channel and schema.
struct Handlers {
  std::function<void(const Message&, const Channel&, const Schema&)> message{};
  std::function<void(const Attachment&)> attachment{};
  std::function<void(const Metadata&)> metadata{};
  /// Asked before each record of the file, for example a chunk; false ends reading.
  std::function<bool()> go_on{};
  /// Chunks that end before are not unpacked; messages in others may still be earlier.
  std::int64_t from_ns = std::numeric_limits<std::int64_t>::min();
};

/// Passes the content of a file to the handlers, in the order of the file. Of a file that is
/// damaged, or whose writer was killed, it reads all chunks with a correct checksum. As the format
/// demands, it passes over private records (opcodes from 0x80 on), opcodes of later versions and
/// fields that were added at the end of a record. Fails only if the file cannot be read, is not
/// MCAP at all, or all its chunks have an unknown compression; an empty file counts as truncated.
/// Takes one pass over the file and the memory of one chunk.
Result<Damage> read(const std::filesystem::path& file, const Handlers& handlers);

}  // namespace swarm::mcap
