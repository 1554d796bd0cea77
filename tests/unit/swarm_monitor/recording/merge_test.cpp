// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/recording/merge.hpp"

#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "swarm_core/robot_log/reader.hpp"
#include "swarm_core/robot_log/robot_log_file.hpp"
#include "swarm_monitor/audit/audit.hpp"
#include "swarm_monitor/audit/recorded_run.hpp"
#include "swarm_monitor/recording/bus_tap.hpp"
#include "swarm_monitor/recording/live_recorder.hpp"
#include "tests/unit/swarm_monitor/synthetic_run.hpp"

namespace swarm::monitor {
namespace {

void expect_same_track(const Track& a, const Track& b) {
  EXPECT_EQ(a.robot, b.robot);
  EXPECT_EQ(a.radius_m, b.radius_m);
  EXPECT_EQ(a.processes, b.processes);
  EXPECT_EQ(a.ended_gracefully, b.ended_gracefully);
  EXPECT_EQ(a.late_ticks, b.late_ticks);
  EXPECT_EQ(a.refused, b.refused);
  EXPECT_EQ(a.states_sent, b.states_sent);
  EXPECT_EQ(a.state_age.count(), b.state_age.count());
  EXPECT_EQ(a.notes.size(), b.notes.size());
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t k = 0; k < a.points.size(); ++k) {
    EXPECT_EQ(a.points[k].time_s, b.points[k].time_s);
    EXPECT_EQ(a.points[k].position_m, b.points[k].position_m);
    EXPECT_EQ(a.points[k].mode, b.points[k].mode);
  }
}

TEST(Merge, MakesARecordingThatReadsAsTheDirectoryDoes) {
  SyntheticRun files(3);
  files.write_good_run();
  // Robot 1 was respawned, robot 2 ends last and was killed.
  files.write(1, {.positions_m = straight({20, 15}, {28, 15}, 40),
                  .begin_s = 25.0,
                  .process_id = 2001,
                  .refused = {1, 2},
                  .ages_us = {500}});
  files.write(2,
              {.positions_m = straight({20, 5}, {28, 5}, 80), .begin_s = 30.0, .graceful = false});
  files.write_file("events.jsonl",
                   "{\"utc_ns\":" + std::to_string(at_s(1.5).time_since_epoch().count()) +
                       ",\"source\":\"launcher\",\"severity\":\"info\",\"code\":\"start\"}\n");
  files.write_file("summary.json", "{\"outcome\": \"ok\"}\n");
  const auto directory = read_run(files.dir());
  ASSERT_TRUE(directory) << directory.error().message;

  const auto merged = merge_run(files.dir(), {});
  ASSERT_TRUE(merged) << merged.error().message;
  const auto recording = read_run(merged->file);

  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(merged->file, files.dir() / "recording.mcap");
  EXPECT_EQ(recording->begin, directory->begin);
  EXPECT_EQ(recording->launcher_summary, directory->launcher_summary);
  ASSERT_EQ(recording->events.size(), 1U);
  EXPECT_EQ(recording->events[0].time_s, directory->events[0].time_s);
  ASSERT_EQ(recording->tracks.size(), directory->tracks.size());
  for (std::size_t i = 0; i < directory->tracks.size(); ++i) {
    expect_same_track(recording->tracks[i], directory->tracks[i]);
  }
}

TEST(Merge, PutsAllMessagesInTheOrderOfTime) {
  SyntheticRun files(4);
  for (std::uint32_t i = 0; i < 4; ++i) {
    files.write(i, {.positions_m = straight({5, 5}, {6, 5}, 20), .begin_s = 0.35 * (4 - i)});
  }
  const auto merged = merge_run(files.dir(), files.dir() / "all.mcap");
  ASSERT_TRUE(merged) << merged.error().message;

  std::int64_t latest_ns = 0;
  std::uint64_t messages = 0;
  const auto damage = mcap::read(
      merged->file,
      {.message = [&](const mcap::Message& message, const mcap::Channel&, const mcap::Schema&) {
        EXPECT_GE(message.log_time_ns, latest_ns);
        latest_ns = message.log_time_ns;
        ++messages;
      }});

  ASSERT_TRUE(damage);
  EXPECT_TRUE(damage->ended);
  // Of each robot a header, 21 steps, counters and the note of its exit.
  EXPECT_EQ(messages, 4U * 24U);
  EXPECT_EQ(merged->messages, messages);
}

TEST(Merge, AttachesWhatTheAuditNeedsAndNothingElse) {
  SyntheticRun files(1);
  files.write(0, {.positions_m = straight({5, 5}, {6, 5}, 5)});
  for (const char* name : {"plan.json", "plan-0002.json", "scene.jsonl", "planning.json",
                           "plan_clock.jsonl", "notes.txt", "report.html", "planning.yaml"}) {
    files.write_file(name, std::string("content of ") + name);
  }
  ASSERT_TRUE(merge_run(files.dir(), {}));

  std::map<std::string, mcap::Attachment> attachments;
  const auto damage =
      mcap::read(files.dir() / "recording.mcap",
                 {.attachment = [&](const mcap::Attachment& a) { attachments[a.name] = a; }});

  ASSERT_TRUE(damage);
  EXPECT_EQ(attachments.size(), 6U);
  for (const auto& [name, type] : {std::pair{"plan.json", "application/json"},
                                   {"plan-0002.json", "application/json"},
                                   {"scene.jsonl", "application/jsonl"},
                                   {"planning.json", "application/json"},
                                   {"plan_clock.jsonl", "application/jsonl"}}) {
    EXPECT_EQ(attachments[name].data, std::string("content of ") + name);
    EXPECT_EQ(attachments[name].media_type, type);
  }
  EXPECT_EQ(attachments["mission.resolved.yaml"].media_type, "application/yaml");
}

TEST(Merge, GoesOnPastFilesThatAreDamaged) {
  SyntheticRun files(3);
  files.write_good_run();
  const auto log_of = [&](std::uint32_t robot) {
    return robot_log::file_of(files.dir(), RobotId(robot));
  };
  std::filesystem::resize_file(log_of(0), std::filesystem::file_size(log_of(0)) / 2);
  std::ofstream(log_of(1), std::ios::binary) << "this is no recording";

  const auto merged = merge_run(files.dir(), {});

  ASSERT_TRUE(merged) << merged.error().message;
  EXPECT_EQ(merged->boxes, 2U) << "that could be read";
  EXPECT_GE(merged->damaged, 1U);
  EXPECT_EQ(merged->unended, 1U);
  const auto run = read_run(merged->file);
  ASSERT_TRUE(run);
  EXPECT_EQ(run->tracks[2].points.size(), 201U);
  EXPECT_GT(run->tracks[0].points.size(), 90U) << "about half of its 201";
  EXPECT_LT(run->tracks[0].points.size(), 110U);
  EXPECT_TRUE(run->tracks[1].points.empty());
  EXPECT_EQ(run->tracks[1].unreadable, "the recording holds nothing of this robot");
}

/// Overwrites three bytes of a file.
void damage(const std::filesystem::path& path, std::streamoff at) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(at);
  file.write("\x01\x02\x03", 3);
}

TEST(Merge, MakesNoGoodRunOfDamagedLogs) {
  SyntheticRun files(2);
  files.write_good_run();
  damage(robot_log::file_of(files.dir(), RobotId(1)), 4000);  // behind its schemas
  const auto merged = merge_run(files.dir(), {});
  ASSERT_TRUE(merged) << merged.error().message;
  EXPECT_EQ(merged->lost, 1U);

  EXPECT_EQ(audit_run(merged->file).value().reasons,
            std::vector<std::string>{"missing: 1 records of the robot logs that were merged"});
}

TEST(Merge, IsNoGoodRunOnceItIsDamaged) {
  SyntheticRun files(2);
  files.write_good_run();
  files.write_file("summary.json", "{\"marker\": 1}\n");  // the last attachment
  const auto merged = merge_run(files.dir(), {});
  ASSERT_TRUE(merged) << merged.error().message;
  EXPECT_TRUE(audit_run(merged->file).value().ok());
  std::ifstream file(merged->file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  damage(merged->file, static_cast<std::streamoff>(bytes.find("marker")));

  EXPECT_EQ(audit_run(merged->file).value().reasons,
            std::vector<std::string>{"missing: what 1 damaged place of the recording held"});
}

TEST(Merge, DoesNotOverwriteARecording) {
  SyntheticRun files(1);
  files.write(0, {.positions_m = straight({5, 5}, {6, 5}, 5)});
  ASSERT_TRUE(merge_run(files.dir(), {}));

  EXPECT_FALSE(merge_run(files.dir(), {}));
}

TEST(Merge, ReportsADirectoryThatIsNoRun) {
  SyntheticRun files(1);
  const auto merged = merge_run(files.dir(), {});
  ASSERT_FALSE(merged);
  EXPECT_EQ(merged.error().code, ErrorCode::kEnvironment);
  EXPECT_EQ(merged.error().message, files.dir().string() +
                                        " holds no robot log and no recording: "
                                        "is it a run directory?");
}

TEST(Merge, ReportsItsCountersAsJson) {
  const auto json = nlohmann::json::parse(to_json(MergeResult{.file = "a.mcap",
                                                              .messages = 5,
                                                              .boxes = 4,
                                                              .unended = 3,
                                                              .damaged = 2,
                                                              .lost = 6,
                                                              .recordings = 1}));
  EXPECT_EQ(json, (nlohmann::json{{"file", "a.mcap"},
                                  {"messages", 5},
                                  {"boxes", 4},
                                  {"unended", 3},
                                  {"damaged", 2},
                                  {"lost", 6},
                                  {"recordings", 1}}));
}

TEST(Merge, ReportsAPathThatIsNotUtf8) {
  const auto json = nlohmann::json::parse(to_json(MergeResult{.file = "caf\xe9.mcap"}));
  EXPECT_EQ(json["file"], "caf\xef\xbf\xbd.mcap");
}

TEST(RecordResult, HasAnObjectOfTopicsAlsoIfNothingWasReceived) {
  RecordResult result{.file = "bus.mcap",
                      .by_topic = std::vector<std::uint64_t>(recorded_topics().size())};
  EXPECT_EQ(nlohmann::json::parse(to_json(result))["topics"], nlohmann::json::object());

  result.by_topic.front() = 7;

  EXPECT_EQ(nlohmann::json::parse(to_json(result))["topics"],
            (nlohmann::json{{recorded_topics().front().name, 7}}));
}

}  // namespace
}  // namespace swarm::monitor
