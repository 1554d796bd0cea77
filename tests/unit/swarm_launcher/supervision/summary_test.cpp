// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/supervision/summary.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "swarm_monitor/audit/audit.hpp"
#include "tests/unit/swarm_core/app/scratch_folder.hpp"
#include "tests/unit/swarm_monitor/synthetic_run.hpp"

namespace swarm::launcher {
namespace {

using nlohmann::json;

struct Summarised {
  ExitCode code;
  std::string printed;
  json file;
};

Summarised summarise_quietly(const std::filesystem::path& dir, const Measurements& measured,
                             bool as_json = true) {
  testing::internal::CaptureStdout();
  const auto code = summarise(dir, measured, as_json);
  std::string printed = testing::internal::GetCapturedStdout();
  EXPECT_TRUE(code) << code.error().message;
  std::ifstream in(dir / "summary.json");
  return {code.value_or(ExitCode::kUsage), printed, json::parse(in)};
}

std::set<std::string> keys_of(const json& object) {
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.insert(key);
  return keys;
}

Measurements completed() {
  return {.outcome = Outcome::kCompleted,
          .channel = Channel::kGroups,
          .discovery_s = 1.5,
          .neighbour_discovery_s = 0.25,
          .cpu_s = 12.5,
          .max_rss_mb = 40.0,
          .refused_by_launcher = 3,
          .plan_ms = 7.5,
          .wall_s = 2.0,
          .ns_per_agent_step = 800.0};
}

/// Only how the run ended is known.
Measurements ended(Outcome outcome) {
  Measurements measured;
  measured.outcome = outcome;
  return measured;
}

TEST(Summary, HoldsWhatTheLauncherMeasuredBesideTheAudit) {
  const monitor::SyntheticRun run(4);
  run.write_good_run();

  const Summarised got = summarise_quietly(run.dir(), completed());

  EXPECT_EQ(got.code, ExitCode::kOk);
  EXPECT_EQ(got.file["outcome"], "ok");
  EXPECT_EQ(got.file["arrived"], 4);
  EXPECT_EQ(got.file["channel"], "groups");
  EXPECT_EQ(got.file["discovery_s"], 1.5);
  EXPECT_EQ(got.file["hearing_s"], 0.25);
  EXPECT_EQ(got.file["cpu_s"], 12.5);
  EXPECT_EQ(got.file["max_rss_mb"], 40.0);
  EXPECT_EQ(got.file["refused_by_launcher"], 3);
  EXPECT_EQ(got.file["plan_ms"], 7.5);
  EXPECT_EQ(got.file["wall_s"], 2.0);
  EXPECT_EQ(got.file["ns_per_agent_step"], 800.0);
  EXPECT_EQ(json::parse(got.printed), got.file) << "with --json the file is printed";
  EXPECT_TRUE(std::filesystem::exists(run.dir() / "report.html"));
}

TEST(Summary, OfARunWithoutAnyStepHasTheSameKeys) {
  const monitor::SyntheticRun flown(2);
  flown.write_good_run();
  const ScratchFolder nothing;

  const Summarised full = summarise_quietly(flown.dir(), completed());
  const Summarised empty = summarise_quietly(nothing.path(), completed());

  EXPECT_EQ(keys_of(empty.file), keys_of(full.file));
  EXPECT_EQ(empty.file["reasons"].size(), 1U) << "why there was nothing to audit";
  EXPECT_EQ(empty.code, ExitCode::kCriteriaNotMet);
}

TEST(Summary, HasNullForWhatWasNeverMeasured) {
  const monitor::SyntheticRun run(2);
  run.write_good_run();

  const Summarised got = summarise_quietly(run.dir(), ended(Outcome::kCompleted));

  for (const char* key : {"plan_ms", "discovery_s", "hearing_s"}) {
    EXPECT_TRUE(got.file.contains(key) && got.file[key].is_null()) << key;
  }
  EXPECT_EQ(got.file["channel"], "lock-step");
  EXPECT_FALSE(got.file.contains("wall_s"));
}

TEST(Summary, DecidesTheExitCodeByHowTheRunEnded) {
  const monitor::SyntheticRun run(2);
  run.write_good_run();
  for (int i = 0; i <= static_cast<int>(Outcome::kAllLost); ++i) {
    const auto outcome = static_cast<Outcome>(i);
    const Summarised got = summarise_quietly(run.dir(), ended(outcome));
    if (outcome == Outcome::kCompleted) {
      EXPECT_EQ(got.code, ExitCode::kOk);
      EXPECT_EQ(got.file["outcome"], "ok");
    } else {
      EXPECT_EQ(got.code, outcome == Outcome::kQuorumTimeout ? ExitCode::kEnvironment
                                                             : ExitCode::kCriteriaNotMet);
      EXPECT_EQ(got.file["outcome"], to_string(outcome));
    }
  }
}

// The robots arrived and touched nothing, but the records do not prove it.
TEST(Summary, IsNotOkWhereEvidenceIsMissing) {
  const monitor::SyntheticRun run(2);
  run.write_good_run();
  Measurements measured = completed();
  measured.missing = {"launcher: scene.jsonl: 2 records (No space left on device)"};

  const Summarised got = summarise_quietly(run.dir(), measured);

  EXPECT_EQ(got.code, ExitCode::kCriteriaNotMet);
  EXPECT_EQ(got.file["outcome"], "criteria_not_met");
  EXPECT_EQ(got.file["missing"], json(measured.missing));
  EXPECT_EQ(got.file["reasons"], json({"missing: " + measured.missing[0]}));
  // A later audit comes to the same result.
  const auto again = monitor::audit_run(run.dir());
  ASSERT_TRUE(again);
  EXPECT_EQ(again->missing, measured.missing);
}

TEST(Summary, IsPrintedAndNotOkWhereItCannotBeWritten) {
  const monitor::SyntheticRun run(2);
  run.write_good_run();
  std::filesystem::create_directory(run.dir() / "summary.json");
  Measurements measured = completed();
  measured.missing = {"planner: plan.json: all of it"};
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const auto code = summarise(run.dir(), measured, false);
  const std::string printed = testing::internal::GetCapturedStdout();
  const std::string complaint = testing::internal::GetCapturedStderr();

  EXPECT_EQ(code, ExitCode::kCriteriaNotMet);
  EXPECT_NE(printed.find("2 of 2 robots arrived"), std::string::npos) << printed;
  EXPECT_NE(printed.find("missing: planner: plan.json: all of it"), std::string::npos) << printed;
  EXPECT_NE(complaint.find("summary.json"), std::string::npos) << complaint;
}

TEST(Summary, CountsThePlansThatExceedTheirRiskLimit) {
  const monitor::SyntheticRun run(2);
  run.write_good_run();
  run.write_file("plan-2.json", R"({"excess_m": 0.25})");
  run.write_file("plan-3.json", R"({"excess_m": 0.75})");
  run.write_file("plan-4.json", R"({"excess_m": 0})");
  run.write_file("plan-5.json", "half a fi");
  run.write_file("plan-6.svg", R"({"excess_m": 9})");
  run.write_file("planning.json", R"({"excess_m": 9})");

  const Summarised got = summarise_quietly(run.dir(), completed());

  EXPECT_EQ(got.file["plans"], 4);
  EXPECT_EQ(got.file["plans_with_excess"], 2);
  EXPECT_EQ(got.file["plan_excess_m"], 0.75);
  const Summarised text = summarise_quietly(run.dir(), completed(), false);
  EXPECT_NE(text.printed.find("broken by 2 of 4 plans, by up to 0.75 m"), std::string::npos)
      << text.printed;
}

TEST(Summary, TakesThePlanningTimeFromThePlannerUnlessItWasMeasured) {
  const monitor::SyntheticRun run(2);
  run.write_good_run();
  run.write_file("plan_stats.json", R"({"total_ms": 42.5})");
  EXPECT_EQ(summarise_quietly(run.dir(), {}).file["plan_ms"], 42.5);
  EXPECT_EQ(summarise_quietly(run.dir(), completed()).file["plan_ms"], 7.5);
  for (const char* rubbish : {"", "[1]", "{}", "{\"total_ms\":"}) {
    run.write_file("plan_stats.json", rubbish);
    EXPECT_TRUE(summarise_quietly(run.dir(), {}).file["plan_ms"].is_null()) << rubbish;
  }
}

}  // namespace
}  // namespace swarm::launcher
