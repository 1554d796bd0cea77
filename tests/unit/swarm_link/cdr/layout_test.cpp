// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// CDR of messages with every type of field, against an encoder that writes byte by byte.
#include "swarm_link/cdr/layout.hpp"

#include <algorithm>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_link/cdr/codec.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::link {
namespace {

enum class Colour : std::uint8_t { kRed, kBlue };

struct Inner {
  std::uint8_t a = 0;
  std::uint64_t b = 0;
  bool operator==(const Inner&) const = default;

  using M = Inner;
  static constexpr FieldList<&M::a, &M::b> kFields{};
};

/// Small fields before large ones, so that each kind of padding occurs.
struct Mixed {
  bool yes = false;
  std::uint16_t u16 = 0;
  Colour colour = Colour::kRed;
  double number = 0;
  std::string text{};
  std::int64_t i64 = 0;
  std::vector<std::uint8_t> bytes{};
  std::uint32_t u32 = 0;
  std::vector<Inner> inners{};
  std::int32_t i32 = 0;
  Inner inner{};
  std::uint8_t last = 0;
  bool operator==(const Mixed&) const = default;

  using M = Mixed;
  static constexpr FieldList<&M::yes, &M::u16, &M::colour, &M::number, up_to(6, &M::text), &M::i64,
                             up_to(5, &M::bytes), &M::u32, up_to(3, &M::inners), &M::i32, &M::inner,
                             &M::last>
      kFields{};
};

/// Plain CDR as the standard describes it: padding to the size of a number, then its bytes.
struct NaiveCdr {
  bool big_endian = false;
  std::size_t begin = 0;  ///< alignment at which the value begins
  std::vector<std::byte> bytes{};

  template <class T>
  void number(T value) {
    while ((begin + bytes.size()) % sizeof(T) != 0) bytes.push_back(std::byte{0});
    std::vector<std::byte> own(sizeof(T));
    std::memcpy(own.data(), &value, sizeof(T));
    if (big_endian) std::reverse(own.begin(), own.end());
    bytes.insert(bytes.end(), own.begin(), own.end());
  }
  void put(const Inner& m) {
    number(m.a);
    number(m.b);
  }
  void put(const Mixed& m) {
    number<std::uint8_t>(m.yes ? 1 : 0);
    number(m.u16);
    number(m.colour);
    number(m.number);
    number(static_cast<std::uint32_t>(m.text.size() + 1));
    for (const char c : m.text) number(c);
    number('\0');
    number(m.i64);
    number(static_cast<std::uint32_t>(m.bytes.size()));
    for (const std::uint8_t b : m.bytes) number(b);
    number(m.u32);
    number(static_cast<std::uint32_t>(m.inners.size()));
    for (const Inner& i : m.inners) put(i);
    number(m.i32);
    put(m.inner);
    number(m.last);
  }
};

Mixed random_message(Rng& rng) {
  Mixed m{.yes = rng() % 2 == 0,
          .u16 = static_cast<std::uint16_t>(rng()),
          .colour = rng() % 2 == 0 ? Colour::kRed : Colour::kBlue,
          .number = uniform(rng, -1e9, 1e9),
          .text = std::string(rng() % 7, static_cast<char>('a' + rng() % 26)),
          .i64 = static_cast<std::int64_t>(rng()),
          .u32 = static_cast<std::uint32_t>(rng()),
          .i32 = static_cast<std::int32_t>(rng()),
          .inner = {.a = static_cast<std::uint8_t>(rng()), .b = rng()},
          .last = static_cast<std::uint8_t>(rng())};
  m.bytes.resize(rng() % 6);
  for (auto& b : m.bytes) b = static_cast<std::uint8_t>(rng());
  m.inners.resize(rng() % 4);
  for (auto& i : m.inners) i = {.a = static_cast<std::uint8_t>(rng()), .b = rng()};
  return m;
}

std::vector<std::byte> naive(const Mixed& message, bool big_endian) {
  NaiveCdr cdr{.big_endian = big_endian};
  cdr.put(message);
  std::vector<std::byte> bytes = {std::byte{0}, std::byte{0}, std::byte{0}, std::byte{0}};
  if (!big_endian) bytes[1] = std::byte{1};
  bytes.insert(bytes.end(), cdr.bytes.begin(), cdr.bytes.end());
  return bytes;
}

TEST(Cdr, IsWhatANaiveEncoderWritesAndBothByteOrdersComeBack) {
  Rng rng(41);
  std::vector<std::byte> bytes;
  for (int i = 0; i < 2'000; ++i) {
    const Mixed message = random_message(rng);

    ASSERT_TRUE(encode(message, bytes));

    EXPECT_EQ(bytes, naive(message, false));
    Mixed back;
    ASSERT_TRUE(decode(bytes, back));
    EXPECT_EQ(back, message);
    ASSERT_TRUE(decode(naive(message, true), back));
    EXPECT_EQ(back, message);
  }
}

TEST(Cdr, DoesNotDependOnWhereItsBytesLie) {
  Rng rng(42);
  const Mixed message = random_message(rng);
  const auto bytes = naive(message, false);
  for (std::size_t offset = 0; offset < 8; ++offset) {
    std::vector<std::byte> moved(offset, std::byte{0xEE});
    moved.insert(moved.end(), bytes.begin(), bytes.end());
    Mixed back;
    ASSERT_TRUE(decode(std::span(moved).subspan(offset), back));
    EXPECT_EQ(back, message);
  }
}

TEST(Cdr, IgnoresBytesAfterTheSample) {
  Rng rng(43);
  const Mixed message = random_message(rng);
  auto bytes = naive(message, true);
  bytes.resize(bytes.size() + 9, std::byte{0xEE});
  Mixed back;
  ASSERT_TRUE(decode(bytes, back));
  EXPECT_EQ(back, message);
}

TEST(Cdr, RefusesABoolThatIsNeitherZeroNorOne) {
  Mixed back;
  auto bytes = naive({}, false);
  for (unsigned value = 0; value < 256; ++value) {
    bytes[4] = std::byte{static_cast<unsigned char>(value)};
    EXPECT_EQ(decode(bytes, back), value <= 1) << value;
  }
}

TEST(Cdr, DecodesMoreElementsThanTheBoundForTheGateToCount) {
  Mixed message;
  message.bytes.assign(9, 7);  // the bound is 5
  std::vector<std::byte> bytes;
  EXPECT_FALSE(encode(message, bytes));
  Mixed back;
  ASSERT_TRUE(decode(naive(message, false), back));
  EXPECT_EQ(back.bytes.size(), 9U);
}

TEST(Aligned, IsTheNextMultiple) {
  for (const std::size_t size : {1U, 2U, 4U, 8U}) {
    for (std::size_t at = 0; at < 100; ++at) {
      std::size_t expected = at;
      while (expected % size != 0) ++expected;
      EXPECT_EQ(cdr::aligned(at, size), expected);
    }
  }
}

// No sample may need more than the room that is made for it, nor fewer bytes than a received length
// is compared with, wherever it begins.
TEST(Layout, BoundsTheBytesOfEveryMessage) {
  Rng rng(44);
  std::size_t largest_inner = 0;
  for (int i = 0; i < 4'000; ++i) {
    const Mixed message = random_message(rng);
    NaiveCdr cdr{.begin = rng() % 8};
    cdr.put(message);
    EXPECT_LE(cdr.bytes.size(), cdr::room_for(message));
    EXPECT_LE(cdr.bytes.size(), cdr::most_bytes<Mixed>());
    EXPECT_GE(cdr.bytes.size(), cdr::least_bytes<Mixed>());
    NaiveCdr inner{.begin = cdr.begin};
    inner.put(message.inner);
    largest_inner = std::max(largest_inner, inner.bytes.size());
  }
  EXPECT_EQ(cdr::most_bytes<Inner>(), largest_inner) << "exact without sequences";
  EXPECT_EQ(cdr::least_bytes<Inner>(), 9U);
}

}  // namespace
}  // namespace swarm::link
