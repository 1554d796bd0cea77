// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/cdr_writer.hpp"

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::monitor {
namespace {

std::vector<int> numbers(const std::vector<std::byte>& bytes) {
  std::vector<int> values;
  for (const std::byte b : bytes) values.push_back(std::to_integer<int>(b));
  return values;
}

TEST(CdrWriter, BeginsWithTheEncapsulationOfPlainLittleEndian) {
  EXPECT_EQ(numbers(CdrWriter().take()), (std::vector<int>{0, 1, 0, 0}));
}

TEST(CdrWriter, PadsEveryNumberToAMultipleOfItsSize) {
  CdrWriter cdr;
  cdr.put(std::uint8_t{0xAA});
  cdr.put(std::uint16_t{0x0102});
  cdr.put_bool(true);
  cdr.put(std::uint32_t{0x03040506});
  cdr.put(std::uint64_t{0x0708});

  // Offsets count from behind the four bytes of the encapsulation.
  EXPECT_EQ(numbers(cdr.take()), (std::vector<int>{0,    1, 0, 0,                 //
                                                   0xAA, 0, 2, 1,                 // u8, u16
                                                   1,    0, 0, 0,                 // bool
                                                   6,    5, 4, 3, 0, 0, 0, 0,     // u32 and padding
                                                   8,    7, 0, 0, 0, 0, 0, 0}));  // u64
}

TEST(CdrWriter, CountsTheFinalZeroOfAText) {
  CdrWriter cdr;
  cdr.put_string("ab");
  cdr.put_string("");
  cdr.put_length(0x0102);

  EXPECT_EQ(numbers(cdr.take()), (std::vector<int>{0, 1, 0, 0,                  //
                                                   3, 0, 0, 0, 'a', 'b', 0, 0,  // then padding
                                                   1, 0, 0, 0, 0,   0,   0, 0,  //
                                                   2, 1, 0, 0}));
}

TEST(CdrWriter, AlignsRandomSequences) {
  Rng rng(2);
  for (int round = 0; round < 200; ++round) {
    CdrWriter cdr;
    std::size_t end = 0;  // by the rule, behind the encapsulation
    const auto expect = [&](std::size_t size) { end = (end + size - 1) / size * size + size; };
    for (int k = 0; k < 30; ++k) {
      switch (rng() % 5) {
        case 0:
          cdr.put(std::int8_t{-1});
          expect(1);
          break;
        case 1:
          cdr.put(std::int16_t{-1});
          expect(2);
          break;
        case 2:
          cdr.put(1.0F);
          expect(4);
          break;
        case 3:
          cdr.put(1.0);
          expect(8);
          break;
        default:
          cdr.put_string(std::string(k % 5, 'x'));
          expect(4);
          end += static_cast<std::size_t>(k % 5) + 1;
      }
    }
    EXPECT_EQ(cdr.take().size(), 4 + end);
  }
}

TEST(AppendRaw, DoesNotPad) {
  std::vector<std::byte> bytes;
  append_raw(bytes, std::uint8_t{1});
  append_raw(bytes, std::uint32_t{2});
  append_bytes(bytes, "xy", 2);
  append_bytes(bytes, nullptr, 0);

  EXPECT_EQ(numbers(bytes), (std::vector<int>{1, 2, 0, 0, 0, 'x', 'y'}));
}

}  // namespace
}  // namespace swarm::monitor
