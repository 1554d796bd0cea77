// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <map>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "flown_run.hpp"
#include "swarm_core/robot_log/reader.hpp"

namespace swarm::test {
namespace {

/// The messages published on each topic, in order.
std::map<std::string, std::vector<std::string>> messages_of(const std::filesystem::path& file) {
  std::map<std::string, std::vector<std::string>> messages;
  const auto damage =
      mcap::read(file, {.message = [&](const mcap::Message& message, const mcap::Channel& channel,
                                       const mcap::Schema&) {
                   messages[channel.topic].emplace_back(message.data.begin(), message.data.end());
                 }});
  EXPECT_TRUE(damage);
  if (damage) {
    EXPECT_EQ(damage->damaged, 0U);
  }
  return messages;
}

nlohmann::json merge(const std::filesystem::path& run_dir) {
  Program merging("swarm_monitor", {"merge", run_dir.string()});
  EXPECT_EQ(merging.wait(), 0) << merging.err();
  return nlohmann::json::parse(merging.out(), nullptr, false);
}

std::string audit(const std::filesystem::path& from) {
  Program auditing("swarm_monitor", {"audit", "--json", from.string()});
  EXPECT_LE(auditing.wait(), 1) << auditing.err();
  return auditing.out();
}

std::uint64_t steps_in_logs(const std::filesystem::path& run_dir) {
  std::uint64_t steps = 0;
  for (const auto& box : std::filesystem::directory_iterator(run_dir / "blackbox")) {
    steps += messages_of(box.path())["blackbox/step"].size();
  }
  return steps;
}

TEST(Recording, OfAFlightIsReplayedWithTheSameMessagesAndJudgedAlike) {
  FlownRun run({"--channel", "groups", "--record"});
  ASSERT_EQ(run.launcher().wait(), 0) << run.outcome();
  const auto merged = merge(run.dir());
  EXPECT_EQ(merged["boxes"], 12);
  EXPECT_EQ(merged["recordings"], 1);
  EXPECT_EQ(merged["unended"], 0);
  const auto recording = run.dir() / "recording.mcap";
  auto first = messages_of(recording);
  EXPECT_EQ(first["blackbox/step"].size(), steps_in_logs(run.dir()));
  for (const char* topic : {"swarm/plan", "swarm/heartbeat", "swarm/command", "swarm/status",
                            "swarm/event", "swarm/cell"}) {
    EXPECT_FALSE(first[topic].empty()) << topic;
  }
  const std::string judged = audit(run.dir());
  EXPECT_EQ(audit(recording), judged);

  TemporaryFolder folder;
  const auto stage = folder.path() / "replay";
  Program replay("swarm_monitor", {"replay", recording.string(), "--out", stage.string(), "--rate",
                                   "4", "--wait-s", "60"});
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(stage / "run.json"); }));
  Program record("swarm_monitor", {"record", stage.string()});
  ASSERT_EQ(replay.wait(), 0) << replay.err();
  ASSERT_EQ(record.wait(), 0) << record.err();
  merge(stage);

  auto second = messages_of(stage / "recording.mcap");
  for (const auto& [topic, messages] : first) {
    EXPECT_EQ(second[topic].size(), messages.size()) << topic;
    EXPECT_TRUE(second[topic] == messages) << topic;
  }
  EXPECT_EQ(audit(stage / "recording.mcap"), judged);
}

TEST(Recording, SurvivesKilledRecordersAndRobots) {
  FlownRun run({"--channel", "groups", "--record"});
  ASSERT_TRUE(run.mission_started());
  const auto recorders = children_of(run.launcher().pid(), "swarm_monitor");
  ASSERT_EQ(recorders.size(), 1U);
  ASSERT_TRUE(eventually([&] {
    return std::filesystem::exists(run.dir() / "bus.mcap") &&
           !messages_of(run.dir() / "bus.mcap")["swarm/cell"].empty();
  }));
  ::kill(recorders.front(), SIGKILL);
  ::kill(run.agents().front(), SIGKILL);

  EXPECT_EQ(run.launcher().wait(), 1) << run.outcome();  // a robot is lost

  EXPECT_EQ(run.summary()["arrived"], 11);
  EXPECT_TRUE(has_event(run.dir(), "recorder-exit"));
  const auto missing = run.summary()["missing"].get<std::vector<std::string>>();
  EXPECT_NE(std::ranges::find(missing, "recording of the bus: its end"), missing.end());
  EXPECT_FALSE(messages_of(run.dir() / "bus.mcap")["swarm/cell"].empty());
  const auto merged = merge(run.dir());
  EXPECT_EQ(merged["unended"], 2);
  EXPECT_EQ(merged["damaged"], 0);
  EXPECT_EQ(audit(run.dir() / "recording.mcap"), audit(run.dir()));
}

/// Limits the size of files, for the programs that are started while this object exists.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    ::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit full{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &full);
  }
  ~FullDisk() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
};

TEST(Recording, OnAFullDiskDoesNotTroubleTheFlight) {
  std::unique_ptr<FlownRun> run;
  {
    const FullDisk disk(20'000);
    run = std::make_unique<FlownRun>(std::vector<std::string>{"--channel", "groups", "--record"});
  }
  run->launcher().wait();

  // The robot logs lack the end of the flight, so the audit counts robots as lost; they flew to the
  // end nevertheless.
  const std::string events = read_text(run->dir() / "events.jsonl");
  EXPECT_NE(events.find("disk-fails"), std::string::npos);
  EXPECT_EQ(events.find("agent-exit"), std::string::npos);
  EXPECT_GT(steps_in_logs(run->dir()), 12U);
  auto bus = messages_of(run->dir() / "bus.mcap");
  EXPECT_FALSE(bus["swarm/cell"].empty());
}

}  // namespace
}  // namespace swarm::test
