// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/channels/groups/rtps_datagram.hpp"

#include <algorithm>

namespace swarm::link {

namespace {

// Constants of the RTPS 2.3 message format.
constexpr std::array<std::uint8_t, 4> kMagic{'R', 'T', 'P', 'S'};
constexpr std::uint8_t kMajor = 2;
constexpr std::uint8_t kMinor = 3;
constexpr std::size_t kHeaderBytes = 20;      // magic, version, vendor, GUID prefix
constexpr std::size_t kSubHeaderBytes = 4;    // kind, flags, octets to the next one
constexpr std::size_t kDataHeaderBytes = 20;  // extra flags, to inline QoS, reader, writer, number
constexpr std::size_t kWriterIdAt = 8;
constexpr std::uint8_t kPad = 0x01;
constexpr std::uint8_t kInfoTimestamp = 0x09;
constexpr std::uint8_t kData = 0x15;
constexpr std::uint8_t kLittleEndian = 0x01;
constexpr std::uint8_t kInlineQos = 0x02;
constexpr std::uint8_t kHasData = 0x04;
// Entity id of our writers: "SWC" and the kind "user-defined writer without key".
constexpr std::array<std::uint8_t, 4> kWriterId{0x53, 0x57, 0x43, 0x03};

std::uint8_t byte_at(std::span<const std::byte> bytes, std::size_t at) {
  return std::to_integer<std::uint8_t>(bytes[at]);
}

bool equal(std::span<const std::byte> bytes, std::span<const std::uint8_t> expected) {
  return std::equal(
      expected.begin(), expected.end(), bytes.begin(),
      [](std::uint8_t e, std::byte b) { return e == std::to_integer<std::uint8_t>(b); });
}

// The sample in the body of a DATA submessage. Our writers send no inline QoS, so a submessage with
// it is refused.
std::optional<std::span<std::byte>> sample_of(std::span<std::byte> body, std::uint8_t flags) {
  if ((flags & kHasData) == 0 || (flags & kInlineQos) != 0) return std::nullopt;
  if (body.size() < kDataHeaderBytes) return std::nullopt;
  if (!equal(body.subspan(kWriterIdAt), kWriterId)) return std::nullopt;
  return body.subspan(kDataHeaderBytes);
}

}  // namespace

// Field by field in the order of the specification, little-endian.
void encode_rtps(const GuidPrefix& writer, std::uint64_t sequence_number,
                 std::span<const std::byte> payload, std::vector<std::byte>& out) {
  out.clear();
  const auto put = [&out](std::uint8_t value) { out.push_back(std::byte{value}); };
  const auto put_all = [&](std::span<const std::uint8_t> values) {
    for (const std::uint8_t value : values) put(value);
  };
  const auto put32 = [&](std::uint32_t value) {
    for (const unsigned shift : {0U, 8U, 16U, 24U}) put((value >> shift) & 0xFFU);
  };
  put_all(kMagic);
  put_all(std::array<std::uint8_t, 4>{kMajor, kMinor, 0, 0});  // vendor id 0: unknown
  put_all(writer);
  // Length 0 means up to the end of the message, which may exceed the 16 bits of this field.
  put_all(std::array<std::uint8_t, 4>{kData, kLittleEndian | kHasData, 0, 0});
  put_all(std::array<std::uint8_t, 4>{0, 0, 16, 0});  // no extra flags; 16 octets to the data
  put_all(std::array<std::uint8_t, 4>{0, 0, 0, 0});   // to any reader
  put_all(kWriterId);
  put32(static_cast<std::uint32_t>(sequence_number >> 32U));
  put32(static_cast<std::uint32_t>(sequence_number & 0xFFFF'FFFFU));
  out.insert(out.end(), payload.begin(), payload.end());
}

// Walks over the submessages up to the first DATA. Each length is checked before it is used. Length
// 0 means up to the end of the message, except in the two kinds that may be empty [DDSI-RTPS,
// 9.4.5.1.3].
std::optional<std::span<std::byte>> decode_rtps(std::span<std::byte> datagram) {
  if (datagram.size() < kHeaderBytes || !equal(datagram, kMagic)) return std::nullopt;
  if (byte_at(datagram, kMagic.size()) != kMajor) return std::nullopt;
  auto rest = datagram.subspan(kHeaderBytes);
  while (rest.size() >= kSubHeaderBytes) {
    const std::uint8_t kind = byte_at(rest, 0);
    const std::uint8_t flags = byte_at(rest, 1);
    const bool little = (flags & kLittleEndian) != 0;
    const std::size_t low = byte_at(rest, little ? 2 : 3);
    const std::size_t high = byte_at(rest, little ? 3 : 2);
    std::size_t length = high << 8U | low;
    rest = rest.subspan(kSubHeaderBytes);
    if (length == 0 && kind != kPad && kind != kInfoTimestamp) length = rest.size();
    if (length > rest.size()) return std::nullopt;
    if (kind == kData) return sample_of(rest.first(length), flags);
    rest = rest.subspan(length);
  }
  return std::nullopt;
}

}  // namespace swarm::link
