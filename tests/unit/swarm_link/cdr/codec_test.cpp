// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/cdr/codec.hpp"

#include <cstring>

#include <gtest/gtest.h>

#include "tests/conformance/samples.hpp"

namespace swarm::link {
namespace {

using Bytes = std::vector<std::byte>;

template <class M>
Bytes bytes_of(const M& message) {
  Bytes bytes;
  EXPECT_TRUE(encode(message, bytes));
  return bytes;
}

template <class M>
bool decodes(std::span<const std::byte> bytes) {
  M message;
  return decode(bytes, message);
}

/// A truncated sample is refused, and decoding stays within the bytes (proved under a sanitizer).
template <class M>
void expect_refused_when_cut() {
  Rng rng(1);
  const Bytes whole = bytes_of(conformance::sample<M>(rng));
  const std::size_t step = 1 + whole.size() / 500;
  for (std::size_t size = 0; size < whole.size(); size += step) {
    const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(decodes<M>(part)) << size;
  }
  EXPECT_TRUE(decodes<M>(whole));
}

template <class... M>
void expect_all_refused_when_cut(MessageList<M...>) {
  (expect_refused_when_cut<M>(), ...);
}

TEST(Codec, RefusesWhatWasCut) { expect_all_refused_when_cut(AllMessages()); }

TEST(Codec, SurvivesAnyDamage) {
  Rng rng(2);
  const Bytes whole = bytes_of(conformance::sample<StatusMessage>(rng));
  for (int i = 0; i < 2000; ++i) {
    Bytes damaged = whole;
    for (int k = 0; k < 8; ++k) damaged[rng() % damaged.size()] = static_cast<std::byte>(rng());
    (void)decodes<StatusMessage>(damaged);
  }
}

TEST(Codec, MakesNoRoomForElementsThatAreNotThere) {
  Bytes bytes = bytes_of(CellStatesMessage{});
  const std::uint32_t claimed = 0xFFFF'FFFF;
  std::memcpy(bytes.data() + bytes.size() - 4, &claimed, sizeof claimed);
  CellStatesMessage batch;
  EXPECT_FALSE(decode(bytes, batch));
  EXPECT_EQ(batch.states.capacity(), 0U);
}

TEST(Codec, RefusesOtherEncapsulations) {
  Bytes bytes = bytes_of(CommandMessage{});
  bytes[1] = std::byte{3};  // a parameter list
  EXPECT_FALSE(decodes<CommandMessage>(bytes));
  bytes[0] = std::byte{1};
  EXPECT_FALSE(decodes<CommandMessage>(bytes));
}

TEST(Codec, WritesNoneOfWhatItsMemoryHeldBefore) {
  Bytes used(4096, std::byte{0xAB});
  ASSERT_TRUE(encode(HeartbeatMessage{}, used));
  EXPECT_EQ(used, bytes_of(HeartbeatMessage{}));
}

TEST(Codec, UsesItsMemoryAgain) {
  CellStatesMessage batch;
  batch.states.resize(50);
  Bytes bytes = bytes_of(batch);
  const auto* memory = bytes.data();
  CellStatesMessage back;
  ASSERT_TRUE(decode(bytes, back));
  const auto* states = back.states.data();
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(encode(batch, bytes));
    ASSERT_TRUE(decode(bytes, back));
  }
  EXPECT_EQ(bytes.data(), memory);
  EXPECT_EQ(back.states.data(), states);
}

TEST(Codec, CutsTexts) {
  const EventMessage event{.code = std::string(70, 'c'), .text = std::string("a\0b", 3)};
  EventMessage back;
  ASSERT_TRUE(decode(bytes_of(event), back));
  EXPECT_EQ(back.code, std::string(64, 'c'));
  EXPECT_EQ(back.text, "a");
}

}  // namespace
}  // namespace swarm::link
