// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <span>
#include <vector>

#include "swarm_link/cdr/decoder.hpp"
#include "swarm_link/cdr/encoder.hpp"
#include "swarm_link/wire_bounds.hpp"

/// Converts a message to the bytes of its topic and back: plain CDR with its encapsulation, by the
/// message's list of fields. tests/conformance/idl checks it against the code that a vendor's
/// generator makes of the IDL.
namespace swarm::link {

/// Encodes into `out` and reuses its memory. False when a sequence is longer than its bound.
template <Message M>
bool encode(const M& message, std::vector<std::byte>& out) {
  static_assert(std::endian::native == std::endian::little);
  if (!fits_wire(message)) return false;
  out.resize(cdr::kEncapsulationBytes + cdr::room_for(message) + cdr::Encoder::kSlack);
  out[0] = out[2] = out[3] = std::byte{0};
  out[1] = std::byte{1};  // little-endian
  cdr::Encoder encoder(out.data() + cdr::kEncapsulationBytes);
  encoder.put(message);
  out.resize(cdr::kEncapsulationBytes + encoder.size());
  return true;
}

/// Decodes either byte order. False when the bytes are not a sample; `out` is then unspecified.
/// Bytes after the sample are padding and are ignored.
template <Message M>
bool decode(std::span<const std::byte> bytes, M& out) {
  if (bytes.size() < cdr::kEncapsulationBytes || bytes[0] != std::byte{0}) return false;
  const auto body = bytes.subspan(cdr::kEncapsulationBytes);
  if (bytes[1] == std::byte{1}) return cdr::Decoder<false>(body).get(out);
  if (bytes[1] == std::byte{0}) return cdr::Decoder<true>(body).get(out);
  return false;
}

}  // namespace swarm::link
