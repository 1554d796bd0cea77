// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "swarm_core/robot_log/idl_text.hpp"
#include "swarm_core/robot_log/reader.hpp"
#include "swarm_core/robot_log/writer.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::mcap {
namespace {

struct Sent {
  std::string topic, schema, data;
  std::uint32_t sequence;
  std::int64_t log_time_ns;
  bool operator==(const Sent&) const = default;
};

struct Content {
  Damage damage;
  std::vector<Sent> messages;
  std::vector<Attachment> attachments;
  std::vector<Metadata> metadata;
};

Content content_of(const std::filesystem::path& file, std::int64_t from_ns = 0) {
  Content content;
  const auto damage =
      read(file, {.message =
                      [&](const Message& m, const Channel& channel, const Schema& schema) {
                        content.messages.push_back({channel.topic, schema.name,
                                                    std::string(m.data.begin(), m.data.end()),
                                                    m.sequence, m.log_time_ns});
                      },
                  .attachment = [&](const Attachment& a) { content.attachments.push_back(a); },
                  .metadata = [&](const Metadata& m) { content.metadata.push_back(m); },
                  .from_ns = from_ns});
  EXPECT_TRUE(damage.has_value());
  if (damage) content.damage = *damage;
  return content;
}

std::span<const unsigned char> bytes_of(const std::string& text) {
  return {reinterpret_cast<const unsigned char*>(text.data()), text.size()};
}

Schema schema_named(const std::string& name) {
  return {.name = name, .encoding = "omgidl", .data = "struct " + name + " {};"};
}

class Mcap : public testing::TestWithParam<Compression> {
 protected:
  Mcap() {
    file_ = std::filesystem::temp_directory_path() /
            ("mcap_test_" + std::to_string(::getpid()) + ".mcap");
    std::filesystem::remove(file_);
  }
  ~Mcap() override { std::filesystem::remove(file_); }

  /// Two channels, `n` messages in turn, a millisecond apart.
  void write(int n, std::size_t size = 20) const {
    auto writer = Writer::create(file_, GetParam());
    ASSERT_TRUE(writer) << writer.error().message;
    const auto a = writer->add_channel("a", schema_named("A"), {{"qos", "reliable"}});
    const auto b = writer->add_channel("b", schema_named("B"));
    for (int i = 0; i < n; ++i) {
      writer->write(i % 2 == 0 ? a : b, i * std::int64_t{1'000'000}, i * std::int64_t{1'000'000},
                    bytes_of(text(i, size)));
    }
    EXPECT_EQ(writer->dropped(), 0U);
    EXPECT_TRUE(writer->finish());
  }
  static std::string text(int i, std::size_t size) {
    std::string text = "message " + std::to_string(i);
    Rng rng(static_cast<std::uint64_t>(i));  // so that it does not compress
    while (text.size() < size) text += static_cast<char>(rng());
    return text;
  }
  std::string file_bytes() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  std::filesystem::path file_;
};

TEST_P(Mcap, ReadsBackWhatWasWritten) {
  write(5);

  const Content content = content_of(file_);

  EXPECT_TRUE(content.damage.ended);
  EXPECT_EQ(content.damage.damaged, 0U);
  ASSERT_EQ(content.messages.size(), 5U);
  EXPECT_EQ(content.messages[3], (Sent{"b", "B", text(3, 20), 1, 3'000'000}));
}

TEST_P(Mcap, KeepsAttachmentsAndMetadata) {
  auto writer = Writer::create(file_, GetParam());
  ASSERT_TRUE(writer);
  writer->add(Attachment{
      .log_time_ns = 7, .name = "mission.yaml", .media_type = "text/yaml", .data = "version: 1"});
  writer->add(Metadata{.name = "run", .values = {{"seed", "3"}}});
  ASSERT_TRUE(writer->finish());

  const Content content = content_of(file_);

  ASSERT_EQ(content.attachments.size(), 1U);
  EXPECT_EQ(content.attachments[0].name, "mission.yaml");
  EXPECT_EQ(content.attachments[0].data, "version: 1");
  ASSERT_EQ(content.metadata.size(), 1U);
  EXPECT_EQ(content.metadata[0].values.at("seed"), "3");
}

TEST_P(Mcap, SkipsWhatIsEarlierThanAskedFor) {
  write(10'000, 500);

  const Content content = content_of(file_, 9'990'000'000);

  ASSERT_EQ(content.messages.size(), 10U);
  EXPECT_EQ(content.messages.front().log_time_ns, 9'990'000'000);
}

TEST_P(Mcap, IsReadAsFarAsItGoesWhenItsEndIsMissing) {
  write(10'000, 500);
  const std::string whole = file_bytes();
  for (const double share : {0.99, 0.7, 0.5, 0.3}) {
    std::ofstream(file_, std::ios::binary | std::ios::trunc)
        << whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size())));

    const Content content = content_of(file_);

    EXPECT_FALSE(content.damage.ended && share < 0.9);
    EXPECT_EQ(content.damage.damaged, 0U);
    ASSERT_GT(content.messages.size(), 1000U);
    for (std::size_t i = 0; i < content.messages.size(); ++i) {
      EXPECT_EQ(content.messages[i].log_time_ns, static_cast<std::int64_t>(i) * 1'000'000);
    }
  }
}

TEST_P(Mcap, LosesOnlyTheChunkThatIsDamaged) {
  write(10'000, 500);
  std::string broken = file_bytes();
  broken[broken.size() / 2] = static_cast<char>(broken[broken.size() / 2] ^ 1);
  std::ofstream(file_, std::ios::binary | std::ios::trunc) << broken;

  const Content content = content_of(file_);

  EXPECT_EQ(content.damage.damaged, 1U);
  EXPECT_TRUE(content.damage.ended);
  EXPECT_GT(content.messages.size(), 7'000U);
  EXPECT_LT(content.messages.size(), 10'000U);
}

// A limit of the file's size refuses writes as a full disk does.
TEST_P(Mcap, LosesAndCountsWhatAFullDiskRefusesAndGoesOn) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    auto writer = Writer::create(file_, Compression::kNone);
    const auto channel = writer->add_channel("a", schema_named("A"));
    const std::string data(1000, 'x');
    const auto say = [&](int from, int to) {
      for (int i = from; i < to; ++i) writer->write(channel, i, i, bytes_of(data));
      writer->flush();
    };
    say(0, 50);
    const rlimit full{.rlim_cur = 60'000, .rlim_max = RLIM_INFINITY};
    ::setrlimit(RLIMIT_FSIZE, &full);
    say(50, 100);
    if (writer->dropped() != 50) ::_exit(1);
    const rlimit roomy{.rlim_cur = RLIM_INFINITY, .rlim_max = RLIM_INFINITY};
    ::setrlimit(RLIMIT_FSIZE, &roomy);
    say(100, 150);
    const auto finished = writer->finish();
    ::_exit(!finished && finished.error().message.find("50 messages") != std::string::npos ? 0 : 2);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_EQ(WEXITSTATUS(status), 0);

  const Content content = content_of(file_);

  EXPECT_EQ(content.damage.damaged, 0U);
  EXPECT_TRUE(content.damage.ended);
  ASSERT_EQ(content.messages.size(), 100U);
  EXPECT_EQ(content.messages[50].log_time_ns, 100);
}

TEST_P(Mcap, DoesNotOverwrite) {
  write(1);
  EXPECT_FALSE(Writer::create(file_, GetParam()));
}

/// Files as programs of later versions of the format, or of others, write them.
class McapOfOthers : public Mcap {
 protected:
  /// Schema, channel and messages from `first` on in one chunk.
  static ChunkContent chunk_of(std::uint32_t first, std::uint32_t messages) {
    ChunkContent chunk;
    append_schema(chunk.records, schema_named("A"));
    append_channel(chunk.records, {.id = 0, .schema = 0, .topic = "a", .encoding = "cdr"});
    for (std::uint32_t i = first; i < first + messages; ++i) {
      chunk.add({.channel = 0,
                 .sequence = i,
                 .log_time_ns = i,
                 .publish_time_ns = i,
                 .data = bytes_of("some data")});
    }
    return chunk;
  }
  static Bytes chunk_record(std::uint32_t first, std::uint32_t messages) {
    Bytes record;
    append_chunk(record, chunk_of(first, messages), GetParam());
    return record;
  }
  static Bytes record_of(unsigned opcode, const std::string& content) {
    Bytes record;
    Put put(record);
    const std::size_t begin = put.begin_record(static_cast<Op>(opcode));
    put.bytes(bytes_of(content));
    put.end_record(begin);
    return record;
  }
  /// The same record with fields that this version does not know.
  static Bytes extended(Bytes record) {
    const std::string added("\0\xFF new field", 12);
    record.insert(record.end(), added.begin(), added.end());
    const std::uint64_t length = record.size() - 9;
    for (std::size_t i = 0; i < 8; ++i) {
      record[1 + i] = static_cast<unsigned char>(length >> (8 * i));
    }
    return record;
  }
  Content content_of_records(const std::vector<Bytes>& records) const {
    Bytes all(kMagic.begin(), kMagic.end());
    append_header(all, "another writer");
    for (const Bytes& record : records) all.insert(all.end(), record.begin(), record.end());
    all.insert(all.end(), plain_end().begin(), plain_end().end());
    std::ofstream(file_, std::ios::binary | std::ios::trunc)
        .write(reinterpret_cast<const char*>(all.data()), static_cast<std::streamsize>(all.size()));
    return content_of(file_);
  }
};

TEST_P(McapOfOthers, PassesOverRecordsThatItDoesNotKnow) {
  for (const unsigned opcode : {0x10U, 0x42U, 0x7FU, 0x80U, 0x85U, 0xFFU}) {
    const Bytes other = record_of(opcode, "calibration");
    const Content content =
        content_of_records({other, chunk_record(0, 3), other, chunk_record(3, 3), other});
    EXPECT_EQ(content.messages.size(), 6U) << opcode;
    EXPECT_EQ(content.damage.damaged, 0U) << opcode;
    EXPECT_TRUE(content.damage.ended) << opcode;
  }
}

TEST_P(McapOfOthers, PassesOverFieldsThatItDoesNotKnow) {
  Bytes metadata;
  append_metadata(metadata, {.name = "about", .values = {{"where", "hall"}}});
  Bytes attachment;
  append_attachment(attachment, {.log_time_ns = 1, .name = "n", .media_type = "t", .data = "d"});
  const Bytes index = record_of(0x07, std::string(6, '\0'));  // of channel 0, without entries
  const Content content =
      content_of_records({extended(metadata), extended(attachment), extended(chunk_record(0, 3)),
                          extended(index), extended(chunk_record(3, 3)), extended(index)});
  EXPECT_EQ(content.messages.size(), 6U);
  EXPECT_EQ(content.metadata.size(), 1U);
  EXPECT_EQ(content.attachments.size(), 1U);
  EXPECT_EQ(content.damage.damaged, 0U);
}

TEST_P(McapOfOthers, RecognisesAChunkWithADamagedOpcode) {
  for (unsigned bit = 0; bit < 8; ++bit) {
    Bytes broken = chunk_record(3, 3);
    broken[0] = static_cast<unsigned char>(broken[0] ^ (1U << bit));
    const Content content = content_of_records({chunk_record(0, 3), broken, chunk_record(6, 3)});
    EXPECT_EQ(content.messages.size(), 6U) << bit;
    EXPECT_EQ(content.damage.damaged, 1U) << bit;
  }
}

TEST_P(McapOfOthers, DoesNotTakeADamagedLengthForNewFields) {
  Bytes broken = chunk_record(3, 3);
  broken[1] = static_cast<unsigned char>(broken[1] + 20);
  const Content content = content_of_records({chunk_record(0, 3), broken, chunk_record(6, 3)});
  EXPECT_EQ(content.damage.damaged, 1U);
  EXPECT_EQ(content.messages.size(), 6U);
}

TEST_P(McapOfOthers, RefusesAnUnknownCompressionByItsName) {
  Bytes record;
  Put put(record);
  const std::size_t begin = put.begin_record(Op::kChunk);
  put.number(std::int64_t{0});
  put.number(std::int64_t{1});
  put.number(std::uint64_t{10});
  put.number(std::uint32_t{0});
  put.text("lz4");
  put.number(std::uint64_t{4});
  put.bytes(bytes_of("abcd"));
  put.end_record(begin);
  Bytes all(kMagic.begin(), kMagic.end());
  all.insert(all.end(), record.begin(), record.end());
  std::ofstream(file_, std::ios::binary)
      .write(reinterpret_cast<const char*>(all.data()), static_cast<std::streamsize>(all.size()));

  const auto damage = read(file_, {});

  ASSERT_FALSE(damage);
  EXPECT_NE(damage.error().message.find("'lz4'"), std::string::npos) << damage.error().message;
}

TEST_P(McapOfOthers, EndsWhereTheReaderWantsNoMore) {
  content_of_records({chunk_record(0, 3), chunk_record(3, 3), chunk_record(6, 3)});
  int taken = 0;
  const auto damage =
      read(file_, {.message = [&](const Message&, const Channel&, const Schema&) { ++taken; },
                   .go_on = [&] { return taken < 3; }});
  ASSERT_TRUE(damage);
  EXPECT_EQ(taken, 3);
  EXPECT_EQ(damage->damaged, 0U);
}

INSTANTIATE_TEST_SUITE_P(Of, McapOfOthers, testing::Values(Compression::kNone, Compression::kZstd),
                         [](const auto& param) {
                           return param.param == Compression::kNone ? "Plain" : "Zstd";
                         });

INSTANTIATE_TEST_SUITE_P(Of, Mcap, testing::Values(Compression::kNone, Compression::kZstd),
                         [](const auto& param) {
                           return param.param == Compression::kNone ? "Plain" : "Zstd";
                         });

TEST(IdlText, IsSelfContained) {
  const std::string states = wire_idl({"RobotState", "CellStates"});
  EXPECT_EQ(states.find("//"), std::string::npos);
  EXPECT_NE(states.find("const unsigned long MAX_CELL_STATES = 256;"), std::string::npos);
  EXPECT_NE(states.find("struct CellStates {"), std::string::npos);
  const std::string step = blackbox_idl({"Step"});
  EXPECT_NE(step.find("struct Step"), std::string::npos);
  EXPECT_EQ(step.find("struct Note"), std::string::npos);
}

}  // namespace
}  // namespace swarm::mcap
