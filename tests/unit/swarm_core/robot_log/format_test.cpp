// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/robot_log/format.hpp"

#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace swarm::mcap {
namespace {

/// Bytes of a text, which may hold NUL.
Bytes bytes(std::string_view text) { return {text.begin(), text.end()}; }
template <std::size_t N>
Bytes literal(const char (&text)[N]) {
  return bytes({text, N - 1});
}

template <class T>
Bytes put(T value) {
  Bytes out;
  Put(out).number(value);
  return out;
}

TEST(McapPut, WritesNumbersLittleEndian) {
  EXPECT_EQ(put(std::uint8_t{0xAB}), literal("\xAB"));
  EXPECT_EQ(put(std::uint16_t{0x1234}), literal("\x34\x12"));
  EXPECT_EQ(put(std::uint32_t{0x12345678}), literal("\x78\x56\x34\x12"));
  EXPECT_EQ(put(std::int64_t{1}), literal("\1\0\0\0\0\0\0\0"));
  EXPECT_EQ(put(std::int64_t{-2}), literal("\xFE\xFF\xFF\xFF\xFF\xFF\xFF\xFF"));
  EXPECT_EQ(put(std::numeric_limits<std::uint64_t>::max()),
            literal("\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF"));
}

TEST(McapPut, WritesTextsWithTheirLength) {
  Bytes out;
  Put put(out);
  put.text("");
  put.text("abc");

  EXPECT_EQ(out, literal("\0\0\0\0\3\0\0\0abc"));
}

TEST(McapPut, WritesMapsWithTheirLengthInBytesAndByAscendingKey) {
  Bytes out;
  Put(out).map({{"b", "2"}, {"a", "11"}});
  Bytes none;
  Put(none).map({});

  EXPECT_EQ(out, literal("\x15\0\0\0\1\0\0\0a\2\0\0\0"
                         "11\1\0\0\0b\1\0\0\0"
                         "2"));
  EXPECT_EQ(none, literal("\0\0\0\0"));
}

TEST(McapPut, SetsTheLengthsOfNestedParts) {
  Bytes out = literal("before");
  Put put(out);
  const std::size_t record = put.begin_record(Op::kMetadata);
  const std::size_t inner = put.begin_length<std::uint16_t>();
  put.number(std::uint8_t{7});
  put.end_length<std::uint16_t>(inner);
  put.end_record(record);

  EXPECT_EQ(out, literal("before\x0C\3\0\0\0\0\0\0\0\1\0\7"));
}

// The check value of CRC-32 in every catalogue of checksums.
TEST(McapCrc, IsThatOfZlib) {
  EXPECT_EQ(crc_of(literal("123456789")), 0xCBF43926U);
  EXPECT_EQ(crc_of({}), 0U);
}

TEST(McapRecords, AreThoseOfTheSpecification) {
  Bytes header, schema, channel, message;
  append_header(header, "lib");
  append_schema(schema, {.id = 1, .name = "N", .encoding = "e", .data = "d"});
  append_channel(channel, {.id = 2, .schema = 1, .topic = "t", .encoding = "cdr"});
  const Bytes data = literal("\0\1xyz");
  append_message(
      message, {.channel = 2, .sequence = 3, .log_time_ns = 4, .publish_time_ns = 5, .data = data});

  EXPECT_EQ(header, literal("\1\x0B\0\0\0\0\0\0\0\0\0\0\0\3\0\0\0lib"));
  EXPECT_EQ(schema, literal("\3\x11\0\0\0\0\0\0\0\1\0\1\0\0\0N\1\0\0\0e\1\0\0\0d"));
  EXPECT_EQ(channel, literal("\4\x14\0\0\0\0\0\0\0\2\0\1\0\1\0\0\0t\3\0\0\0cdr\0\0\0\0"));
  EXPECT_EQ(message, literal("\5\x1B\0\0\0\0\0\0\0\2\0\3\0\0\0\4\0\0\0\0\0\0\0"
                             "\5\0\0\0\0\0\0\0\0\1xyz"));
}

TEST(McapRecords, CoverAnAttachmentByItsChecksum) {
  Bytes out;
  append_attachment(out, {.log_time_ns = 9, .name = "n", .media_type = "m", .data = "data"});

  // Opcode and length, then two times, name, media type and data, then the checksum of all of it.
  const Bytes content = literal(
      "\x9\0\0\0\0\0\0\0\x9\0\0\0\0\0\0\0\1\0\0\0n\1\0\0\0m"
      "\4\0\0\0\0\0\0\0data");
  ASSERT_EQ(out.size(), 9 + content.size() + 4);
  EXPECT_EQ(Bytes(out.begin() + 9, out.end() - 4), content);
  EXPECT_EQ(Bytes(out.end() - 4, out.end()), put(crc_of(content)));
}

TEST(McapChunk, KnowsThePeriodOfItsMessagesInAnyOrder) {
  ChunkContent chunk;
  for (const std::int64_t ns : {50, 20, 70, 60}) chunk.add({.log_time_ns = ns});
  EXPECT_EQ(chunk.begin_ns, 20);
  EXPECT_EQ(chunk.end_ns, 70);
  EXPECT_EQ(chunk.messages, 4U);

  chunk.clear();
  EXPECT_TRUE(chunk.records.empty());
  chunk.add({.log_time_ns = 100});
  EXPECT_EQ(chunk.begin_ns, 100);
  EXPECT_EQ(chunk.end_ns, 100);
  EXPECT_EQ(chunk.messages, 1U);
}

TEST(McapChunk, HasTheSizeAndChecksumOfItsRecords) {
  ChunkContent chunk;
  const Bytes data(1000, 'x');
  for (int i = 0; i < 10; ++i) chunk.add({.log_time_ns = i, .data = data});
  Bytes plain, packed;
  append_chunk(plain, chunk, Compression::kNone);
  append_chunk(packed, chunk, Compression::kZstd);

  // Opcode, length; begin, end; size, checksum; compression; length of the records.
  constexpr std::size_t kSize = 9 + 8 + 8, kCrc = kSize + 8, kName = kCrc + 4;
  for (const Bytes& out : {plain, packed}) {
    EXPECT_EQ(Bytes(out.begin() + 1, out.begin() + 9), put(std::uint64_t{out.size() - 9}));
    EXPECT_EQ(Bytes(out.begin() + kSize, out.begin() + kCrc),
              put(std::uint64_t{chunk.records.size()}));
    EXPECT_EQ(Bytes(out.begin() + kCrc, out.begin() + kName), put(crc_of(chunk.records)));
  }
  EXPECT_EQ(Bytes(plain.begin() + kName, plain.begin() + kName + 4), literal("\0\0\0\0"));
  EXPECT_EQ(Bytes(plain.begin() + kName + 12, plain.end()), chunk.records);
  EXPECT_EQ(Bytes(packed.begin() + kName, packed.begin() + kName + 8), literal("\4\0\0\0zstd"));
  EXPECT_LT(packed.size(), plain.size() / 10);
}

TEST(McapEnd, IsADataEndAFooterAndTheMagicNumber) {
  EXPECT_EQ(plain_end(), literal("\x0F\4\0\0\0\0\0\0\0\0\0\0\0"
                                 "\2\x14\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"
                                 "\x89MCAP0\r\n"));
}

}  // namespace
}  // namespace swarm::mcap
