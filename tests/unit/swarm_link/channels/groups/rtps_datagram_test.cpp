// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/channels/groups/rtps_datagram.hpp"

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::link {
namespace {

using Bytes = std::vector<std::byte>;

Bytes bytes_of(std::initializer_list<int> values) {
  Bytes bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

constexpr GuidPrefix kWriter{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
constexpr std::size_t kHeaderBytes = 20;

Bytes message(const Bytes& payload) {
  Bytes out;
  encode_rtps(kWriter, 0x0000'0001'0000'0002ULL, payload, out);
  return out;
}

TEST(RtpsDatagram, FollowsTheStandard) {
  const Bytes expected = bytes_of({'R',  'T',  'P',  'S', 2, 3, 0, 0,                 //
                                   1,    2,    3,    4,   5, 6, 7, 8, 9, 10, 11, 12,  // GUID prefix
                                   0x15, 0x05, 0,    0,                               // DATA
                                   0,    0,    16,   0,                               //
                                   0,    0,    0,    0,                               // any reader
                                   0x53, 0x57, 0x43, 3,                               // writer
                                   1,    0,    0,    0,   2, 0, 0, 0,  // number, high half first
                                   0,    1,    0,    0,   42});        // CDR, little endian

  EXPECT_EQ(message(bytes_of({0, 1, 0, 0, 42})), expected);
}

TEST(RtpsDatagram, ComesBack) {
  Bytes payload(70'000, std::byte{7});  // longer than the 16-bit length of a submessage
  Bytes sent = message(payload);

  const auto received = decode_rtps(sent);

  ASSERT_TRUE(received);
  EXPECT_TRUE(std::equal(received->begin(), received->end(), payload.begin(), payload.end()));
}

TEST(RtpsDatagram, SkipsSubmessagesBeforeTheSample) {
  Bytes sent = message(bytes_of({0, 1, 0, 0, 42}));
  // INFO_TS of 8 bytes, once in each byte order.
  for (const auto& info : {bytes_of({0x09, 1, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0}),
                           bytes_of({0x09, 0, 0, 8, 0, 0, 0, 0, 0, 0, 0, 0})}) {
    sent.insert(sent.begin() + kHeaderBytes, info.begin(), info.end());
  }

  const auto received = decode_rtps(sent);

  ASSERT_TRUE(received);
  EXPECT_EQ(received->size(), 5U);
}

TEST(RtpsDatagram, RefusesWhatIsNotOurs) {
  const Bytes good = message(bytes_of({0, 1, 0, 0}));
  const auto refused = [&](std::size_t at, int value) {
    Bytes spoiled = good;
    spoiled[at] = static_cast<std::byte>(value);
    return !decode_rtps(spoiled).has_value();
  };
  EXPECT_TRUE(refused(0, 'X'));                   // magic
  EXPECT_TRUE(refused(4, 3));                     // major version
  EXPECT_TRUE(refused(kHeaderBytes, 0x16));       // DATA_FRAG
  EXPECT_TRUE(refused(kHeaderBytes + 1, 0x07));   // inline QoS
  EXPECT_TRUE(refused(kHeaderBytes + 1, 0x01));   // no data
  EXPECT_TRUE(refused(kHeaderBytes + 3, 0xFF));   // longer than the message
  EXPECT_TRUE(refused(kHeaderBytes + 12, 0x00));  // another writer
}

// An INFO_TS that takes the time back, or a PAD, has no content: its length 0 does not mean the
// rest of the message.
TEST(RtpsDatagram, SkipsEmptySubmessagesBeforeTheSample) {
  for (const int kind : {0x01, 0x09}) {
    Bytes sent = message(bytes_of({0, 1, 0, 0, 42}));
    const Bytes empty = bytes_of({kind, 0x03, 0, 0});
    sent.insert(sent.begin() + kHeaderBytes, empty.begin(), empty.end());

    const auto received = decode_rtps(sent);

    ASSERT_TRUE(received) << kind;
    EXPECT_EQ(received->size(), 5U);
  }
}

TEST(RtpsDatagram, HoldsTheSampleOfAStatedLengthAlone) {
  Bytes sent = message(bytes_of({0, 1, 0, 0, 42}));
  sent[kHeaderBytes + 2] = std::byte{20 + 5};  // octets to the next submessage
  const Bytes next = bytes_of({0x01, 1, 0, 0});
  sent.insert(sent.end(), next.begin(), next.end());

  const auto received = decode_rtps(sent);

  ASSERT_TRUE(received);
  EXPECT_EQ(Bytes(received->begin(), received->end()), bytes_of({0, 1, 0, 0, 42}));
}

TEST(RtpsDatagram, RefusesEveryTruncationWithinItsHeaders) {
  const Bytes good = message({});
  ASSERT_EQ(good.size(), 44U);  // "adds 44 bytes to the sample"
  for (std::size_t size = 0; size < good.size(); ++size) {
    Bytes cut(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(decode_rtps(cut)) << size;
  }
}

TEST(RtpsDatagram, DoesNotDependOnWhatItsMemoryHeldBefore) {
  Bytes used(500, std::byte{0xAB});
  encode_rtps(kWriter, 0x0000'0001'0000'0002ULL, bytes_of({0, 1, 0, 0}), used);
  EXPECT_EQ(used, message(bytes_of({0, 1, 0, 0})));
}

// Under the sanitizers this proves that nothing beyond the bytes is read.
TEST(RtpsDatagram, SurvivesNoise) {
  Rng rng(1);
  const Bytes good = message(bytes_of({0, 1, 0, 0, 42}));
  for (int round = 0; round < 100'000; ++round) {
    Bytes noise(static_cast<std::size_t>(uniform(rng, 0.0, 80.0)));
    for (std::size_t i = 0; i < noise.size(); ++i) {
      noise[i] = i < kHeaderBytes && i < good.size() ? good[i] : static_cast<std::byte>(rng());
    }
    const auto payload = decode_rtps(noise);
    if (payload) {
      EXPECT_LE(payload->size(), noise.size() - kHeaderBytes);
    }
  }
}

}  // namespace
}  // namespace swarm::link
