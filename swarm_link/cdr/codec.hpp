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

/// A message as the bytes that travel on its topic, and back: plain CDR with its encapsulation, by
/// the list of its fields. tests/conformance/idl holds it to what a vendor's generator makes of the
/// IDL.
namespace swarm::link {

/// Replaces `out`, whose memory it uses again; false when the message is beyond the contract.
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

/// False when the bytes are not a sample; `out` is unspecified then. What follows behind the sample
/// is padding.
template <Message M>
bool decode(std::span<const std::byte> bytes, M& out) {
  if (bytes.size() < cdr::kEncapsulationBytes || bytes[0] != std::byte{0}) return false;
  const auto body = bytes.subspan(cdr::kEncapsulationBytes);
  if (bytes[1] == std::byte{1}) return cdr::Decoder<false>(body).get(out);
  if (bytes[1] == std::byte{0}) return cdr::Decoder<true>(body).get(out);
  return false;
}

}  // namespace swarm::link
