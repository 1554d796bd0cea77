// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "swarm_core/blackbox/record.hpp"

/// Payloads of black-box records: little-endian, fields in order of the struct.
namespace swarm::blackbox {

/// Largest text kept of a note's code and text, and most refusal counters.
inline constexpr std::size_t kMaxNoteText = 4096;
inline constexpr std::size_t kMaxRefusals = 255;

/// Appends the payload of a record; returns its kind, 1 … 4.
std::uint8_t encode(const Record& record, std::vector<unsigned char>& out);

/// Whether a record of this kind can have a payload of this size.
bool is_plausible(std::uint8_t kind, std::size_t size);

/// The record, or nothing if the payload is malformed or holds numbers that are not finite.
std::optional<Record> decode(std::uint8_t kind, std::span<const unsigned char> payload);

}  // namespace swarm::blackbox
