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
