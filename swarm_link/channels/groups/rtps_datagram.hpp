// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

/// One sample of a best-effort writer as an RTPS 2.3 message: header, one DATA submessage, the
/// serialized sample. What any RTPS tool can read, in 44 bytes more than the sample.
///
/// Not the vendor's reader: that one drops what is older than the newest number it saw of a writer.
/// With one socket per group samples arrive out of order, and a forged number would silence a robot
/// for good; here every sample is handed on, and the edge judges it.
namespace swarm::link {

using GuidPrefix = std::array<std::uint8_t, 12>;

/// Writes a message into `out`, which keeps its memory. The payload begins with its encapsulation.
void encode_rtps(const GuidPrefix& writer, std::uint64_t sequence_number,
                 std::span<const std::byte> payload, std::vector<std::byte>& out);

/// The payload of the first DATA submessage of the groups' writers; nothing when the bytes are not
/// a message, or not one of ours. Never reads beyond the bytes. O(submessages).
std::optional<std::span<std::byte>> decode_rtps(std::span<std::byte> datagram);

}  // namespace swarm::link
