// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "swarm.h"

namespace swarm::link::cdr {

/// Whether bytes begin as those of plain CDR do, of either byte order.
inline bool is_plain(std::span<const std::byte> payload) {
  return payload.size() >= 4 && payload[0] == std::byte{0} && payload[1] <= std::byte{1};
}

/// Whether every sequence in a serialized sample could fit into its bytes. The generated code makes
/// room for as many elements as a sample says before it reads the first: one corrupt length would
/// exhaust memory. Throws what the decoder throws.
template <class Wire>
bool lengths_fit(std::span<std::byte> payload);
template <>
bool lengths_fit<wire::FlowPlan>(std::span<std::byte> payload);
template <>
bool lengths_fit<wire::Scene>(std::span<std::byte> payload);
template <>
bool lengths_fit<wire::Heartbeat>(std::span<std::byte> payload);
template <>
bool lengths_fit<wire::CellStates>(std::span<std::byte> payload);
template <>
bool lengths_fit<wire::Command>(std::span<std::byte> payload);
template <>
bool lengths_fit<wire::Status>(std::span<std::byte> payload);
template <>
bool lengths_fit<wire::Event>(std::span<std::byte> payload);

}  // namespace swarm::link::cdr
