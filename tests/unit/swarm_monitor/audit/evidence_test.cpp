// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/evidence.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_core/app/run_directory.hpp"

namespace swarm::monitor {
namespace {

using Texts = std::vector<std::string>;

RecordedRun run_of(std::uint32_t robots) {
  RecordedRun run;
  for (std::uint32_t i = 0; i < robots; ++i) run.tracks.push_back({.robot = RobotId(i)});
  return run;
}

Scene scene(std::uint64_t version) {
  Scene made;
  made.version = version;
  return made;
}

RunEvent event(const char* code, const char* source = "", const char* text = "") {
  RunEvent made;
  made.source = source;
  made.code = code;
  made.text = text;
  return made;
}

FlowPlan a_plan() { return FlowPlan(); }

TEST(MissingEvidence, IsNothingOfACompleteRun) {
  RecordedRun run = run_of(3);
  run.tracks[0].notes = {{.code = "scene", .text = "took scene version 17"},
                         {.code = "scene", .text = "took scene version x"},
                         {.code = "mode", .text = "took scene version 9"}};
  run.scenes.push_back(scene(17));
  run.clock = {{.plan_version = 0}, {.plan_version = 1}};
  run.plans.push_back({1, a_plan()});
  run.events = {event("disk-fails"), event("disk-works")};
  run.launcher_summary = R"({"missing": []})";
  EXPECT_EQ(missing_evidence(run), Texts{});
}

TEST(MissingEvidence, AreRecordsThatLogsLack) {
  RecordedRun run = run_of(3);
  run.tracks[0].lost = 2;
  run.tracks[2].lost = 40;
  EXPECT_EQ(missing_evidence(run), Texts{"42 records of robot logs: robot 0, 2"});
}

TEST(MissingEvidence, AreScenesThatOnlyRobotsKnow) {
  RecordedRun run = run_of(2);
  for (Track& track : run.tracks) {
    track.notes = {{.code = "scene", .text = "took scene version 17"},
                   {.code = "scene", .text = "took scene version 18"}};
  }
  run.scenes = {scene(0), scene(18)};
  EXPECT_EQ(missing_evidence(run), Texts{"1 scene that robots took and scene.jsonl lacks"});
}

// The planner keeps the first plan and the newest hundred.
TEST(MissingEvidence, ArePlansThatTheClockNamesButForOldOnes) {
  RecordedRun run = run_of(1);
  constexpr std::uint32_t kNewest = 150;
  for (std::uint32_t v = 1; v <= kNewest; ++v) run.clock.push_back({.plan_version = v});
  run.plans.push_back({1, a_plan()});
  for (std::uint32_t v = kNewest - shell::kPlansKept + 1; v <= kNewest; ++v) {
    run.plans.push_back({v, a_plan()});
  }
  EXPECT_EQ(missing_evidence(run), Texts{});
  run.plans.pop_back();
  EXPECT_EQ(missing_evidence(run), Texts{"1 plan that the clock or robots name: version 150"});
  run.plans.erase(run.plans.begin());
  EXPECT_EQ(missing_evidence(run), Texts{"2 plans that the clock or robots name: version 1 …"});
}

// A planner that was killed while the disk was full wrote neither the plan nor its clock.
TEST(MissingEvidence, ArePlansThatRobotsFollowed) {
  RecordedRun run = run_of(2);
  for (const std::uint32_t v : {1, 3}) {
    run.clock.push_back({.plan_version = v});
    run.plans.push_back({v, a_plan()});
  }
  for (const std::uint32_t v : {0, 1, 2, 3}) {
    TrackPoint point;
    point.plan_version = v;
    run.tracks[1].points.push_back(point);
  }
  EXPECT_EQ(missing_evidence(run), Texts{"1 plan that the clock or robots name: version 2"});
}

TEST(MissingEvidence, IsWhatARecordingLacks) {
  RecordedRun run = run_of(1);
  run.gaps = {"the end of the recording"};
  EXPECT_EQ(missing_evidence(run), Texts{"the end of the recording"});
}

TEST(MissingEvidence, IsWhatProcessesReportedAsLost) {
  RecordedRun run = run_of(1);
  run.events = {event("records-lost", "planner", "plan.json: all of it"),
                event("records-lost", "planner", "plan.json: all of it")};
  run.launcher_summary = R"({"missing": ["planner: plan.json: all of it", "launcher: a", 7]})";
  EXPECT_EQ(missing_evidence(run), (Texts{"launcher: a", "planner: plan.json: all of it"}));
  run.launcher_summary = "half of a fi";
  EXPECT_EQ(missing_evidence(run), Texts{"planner: plan.json: all of it"});
}

}  // namespace
}  // namespace swarm::monitor
