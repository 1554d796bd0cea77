// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>

#include "swarmflow/core/result.hpp"
#include "swarm_core/robot_log/format.hpp"

namespace swarm::mcap {

struct Damage {
  std::uint64_t damaged = 0;  ///< stretches of bytes that are no record; reading goes on after them
  bool truncated = false;     ///< the file ends inside a record: its writer was killed
  bool ended = false;         ///< its writer came to an end and said so
};

/// Who wants to have what of a file. A message comes with its channel and schema.
struct Handlers {
  std::function<void(const Message&, const Channel&, const Schema&)> message{};
  std::function<void(const Attachment&)> attachment{};
  std::function<void(const Metadata&)> metadata{};
  /// Chunks that end before are not unpacked; messages in others may still be earlier.
  std::int64_t from_ns = std::numeric_limits<std::int64_t>::min();
};

/// Hands over what a file holds, in its order. A killed writer's file, or one with bytes flipped,
/// is read as far as its chunks' checksums are right. Fails only if the file cannot be read or is
/// no MCAP at all; an empty file is a truncated one. Cost: one pass; memory: a chunk.
Result<Damage> read(const std::filesystem::path& file, const Handlers& handlers);

}  // namespace swarm::mcap
