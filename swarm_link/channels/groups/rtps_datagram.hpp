// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

/// Encodes one sample of a best-effort writer as an RTPS 2.3 message: header, one DATA submessage,
/// the serialized sample. Any RTPS tool can read it; it adds 44 bytes to the sample.
///
/// The vendor's reader is not used, because it drops samples older than the newest sequence number
/// it received from a writer. With one socket per group samples arrive out of order, and one forged
/// number would make a robot unreceivable for good. Here every sample is passed on to the Gate.
namespace swarm::link {

/// Identifies a sending process in RTPS.
using GuidPrefix = std::array<std::uint8_t, 12>;

/// Writes a message into `out` and reuses its memory. The payload begins with its encapsulation.
void encode_rtps(const GuidPrefix& writer, std::uint64_t sequence_number,
                 std::span<const std::byte> payload, std::vector<std::byte>& out);

/// The payload of the first DATA submessage if it comes from a writer of the groups; empty when the
/// bytes are not an RTPS message or not one of ours. Never reads beyond the bytes. O(submessages).
std::optional<std::span<std::byte>> decode_rtps(std::span<std::byte> datagram);

}  // namespace swarm::link
