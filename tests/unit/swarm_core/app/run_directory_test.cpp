// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/run_directory.hpp"

#include <atomic>
#include <limits>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/unit/swarm_core/app/scratch_folder.hpp"

namespace swarm::shell {
namespace {

/// A run none of whose values is a default.
RunInfo unusual_run() {
  return {.domain = 229,
          .discovery_host = "10.1.2.3",
          .discovery_port = 65'535,
          .agents = 20'000,
          .relays = 17,
          .launcher = link::Vendor::kCycloneDds,
          .planner = link::Vendor::kCycloneDds,
          .host = "10.1.2.4",
          .interface = "10.1.2.5",
          .channel = Channel::kGroups,
          .seed = std::numeric_limits<std::uint64_t>::max(),
          .began = UtcTime(Duration(1'700'000'000'123'456'789)),
          .clock = {.boot_id = "a boot", .utc_minus_steady_ns = -12},
          .is_replay = true};
}

TEST(RunInfo, ComesBackFromItsFileAsItWas) {
  const ScratchFolder folder;
  const RunInfo wrote = unusual_run();
  ASSERT_TRUE(write_run_info(folder.path(), wrote));

  const auto read = read_run_info(folder.path());

  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->domain, wrote.domain);
  EXPECT_EQ(read->discovery_host, wrote.discovery_host);
  EXPECT_EQ(read->discovery_port, wrote.discovery_port);
  EXPECT_EQ(read->agents, wrote.agents);
  EXPECT_EQ(read->relays, wrote.relays);
  EXPECT_EQ(read->launcher, wrote.launcher);
  EXPECT_EQ(read->planner, wrote.planner);
  EXPECT_EQ(read->host, wrote.host);
  EXPECT_EQ(read->interface, wrote.interface);
  EXPECT_EQ(read->channel, wrote.channel);
  EXPECT_EQ(read->seed, wrote.seed);
  EXPECT_EQ(read->began, wrote.began);
  EXPECT_EQ(read->clock.boot_id, wrote.clock.boot_id);
  EXPECT_EQ(read->clock.utc_minus_steady_ns, wrote.clock.utc_minus_steady_ns);
  EXPECT_EQ(read->is_replay, wrote.is_replay);
}

TEST(RunInfo, IsRefusedWithoutAnyOneOfItsKeys) {
  const ScratchFolder folder;
  ASSERT_TRUE(write_run_info(folder.path(), unusual_run()));
  const auto whole = nlohmann::json::parse(folder.read("run.json"));
  ASSERT_EQ(whole.size(), 15U);

  for (const auto& [key, value] : whole.items()) {
    auto part = whole;
    part.erase(key);
    folder.write("run.json", part.dump());
    const auto read = read_run_info(folder.path());
    ASSERT_FALSE(read) << key;
    EXPECT_EQ(read.error().code, ErrorCode::kBadInput);
    EXPECT_TRUE(read.error().message.starts_with((folder / "run.json").string() +
                                                 ": not a run directory: "))
        << read.error().message;
    EXPECT_NE(read.error().message.find("'" + key + "'"), std::string::npos)
        << read.error().message;
  }
}

TEST(RunInfo, IsRefusedWhereItsFileIsNoneOrRubbish) {
  const ScratchFolder folder;
  const auto missing = read_run_info(folder.path());
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(missing.error().message,
            "cannot read " + (folder / "run.json").string() + ": No such file or directory");

  for (const char* rubbish : {"", "{", "[]", "7", "null", "\xff\xfe"}) {
    folder.write("run.json", rubbish);
    const auto read = read_run_info(folder.path());
    ASSERT_FALSE(read) << rubbish;
    EXPECT_EQ(read.error().code, ErrorCode::kBadInput);
  }
}

TEST(RunInfo, IsRefusedWithAValueOutOfItsRange) {
  const ScratchFolder folder;
  ASSERT_TRUE(write_run_info(folder.path(), unusual_run()));
  const auto whole = nlohmann::json::parse(folder.read("run.json"));
  const struct {
    const char* key;
    nlohmann::json value;
    std::string message;
  } cases[] = {
      {"discovery_port", 70'000, "discovery_port is 70000, not a whole number from 0 to 65535"},
      {"discovery_port", -1, "discovery_port is -1, not a whole number from 0 to 65535"},
      {"discovery_port", 11.5, "discovery_port is 11.5, not a whole number from 0 to 65535"},
      {"domain", 4294967296, "domain is 4294967296, not a whole number from 0 to 4294967295"},
      {"agents", "12", "agents is \"12\", not a whole number from 0 to 4294967295"},
      {"hubs", -1, "hubs is -1, not a whole number from 0 to 4294967295"},
      {"seed", -1, "seed is -1, not a whole number from 0 to 18446744073709551615"},
      {"began_utc_ns", std::numeric_limits<std::uint64_t>::max(),
       "began_utc_ns is 18446744073709551615, not a whole number from -9223372036854775808 to "
       "9223372036854775807"},
      {"channel", "pigeons", "channel is \"pigeons\", not topics or groups"},
  };
  for (const auto& c : cases) {
    auto json = whole;
    json[c.key] = c.value;
    folder.write("run.json", json.dump());
    const auto read = read_run_info(folder.path());
    ASSERT_FALSE(read) << c.message;
    EXPECT_EQ(read.error().code, ErrorCode::kBadInput);
    EXPECT_EQ(read.error().message,
              (folder / "run.json").string() + ": not a run directory: " + c.message);
  }
}

TEST(WriteFile, ReplacesTheWholeContentAndLeavesNoOtherFile) {
  const ScratchFolder folder;
  for (const std::string& content :
       {std::string("long before"), std::string("short"), std::string(), std::string("a\0b\r\n", 5),
        std::string(300'000, 'x')}) {
    ASSERT_TRUE(write_file(folder / "file", content));
    EXPECT_EQ(folder.read("file"), content);
    EXPECT_EQ(read_file(folder / "file", 300'000), content);
  }
  EXPECT_EQ(folder.entries(), 1) << "the temporary file has been renamed";
}

TEST(WriteFile, NamesTheFileThatCannotBeWritten) {
  const ScratchFolder folder;

  const auto nowhere = write_file(folder / "none/file", "x");
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().code, ErrorCode::kEnvironment);
  EXPECT_TRUE(
      nowhere.error().message.starts_with("cannot write " + (folder / "none/file").string()))
      << nowhere.error().message;

  std::filesystem::create_directories(folder / "taken/by a folder");
  const auto taken = write_file(folder / "taken", "x");
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().code, ErrorCode::kEnvironment);
  EXPECT_EQ(taken.error().message,
            "cannot write " + (folder / "taken").string() + ": Is a directory");
}

// A reader beside a writer that alternates between two contents sees one or the other, whole.
TEST(WriteFile, NeverShowsHalfOfAFileToAReader) {
  const ScratchFolder folder;
  const std::string one(50'000, '1');
  const std::string two(90'000, '2');
  ASSERT_TRUE(write_file(folder / "file", one));
  std::atomic<bool> done = false;
  std::thread writer([&] {
    for (int i = 0; i < 200; ++i) {
      if (!write_file(folder / "file", i % 2 == 0 ? two : one)) break;
    }
    done = true;
  });

  int mixed = 0;
  do {
    std::ifstream in(folder / "file", std::ios::binary);
    const std::string seen{std::istreambuf_iterator<char>(in), {}};
    mixed += seen != one && seen != two ? 1 : 0;
  } while (!done);
  writer.join();

  EXPECT_EQ(mixed, 0);
}

TEST(ReadFile, RefusesOneByteMoreThanAllowed) {
  const ScratchFolder folder;
  folder.write("file", "12345");

  EXPECT_EQ(read_file(folder / "file", 5), "12345");
  const auto refused = read_file(folder / "file", 4);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(refused.error().message, (folder / "file").string() + " is larger than 4 bytes");
}

TEST(ReadFile, ReadsAnEmptyFileEvenWhereNothingIsAllowed) {
  const ScratchFolder folder;
  folder.write("file", "");
  EXPECT_EQ(read_file(folder / "file", 0), "");
}

TEST(ReadFile, RefusesAFolder) {
  const ScratchFolder folder;
  const auto refused = read_file(folder.path(), 1U << 20U);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace swarm::shell
