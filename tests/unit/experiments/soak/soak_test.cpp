// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "experiments/soak/process_sample.hpp"
#include "experiments/soak/soak_mission.hpp"
#include "experiments/soak/soak_paths.hpp"
#include "experiments/soak/soak_result.hpp"
#include "swarm_link/stream_meter.hpp"

namespace swarm::launcher {
namespace {

using std::chrono::microseconds;

constexpr UtcTime kNow{std::chrono::seconds(1'000'000)};

void receive(link::StreamMeter& meter, std::uint32_t robot, std::uint32_t number,
             Duration age = microseconds(500)) {
  meter.receive({.robot_id = robot,
                 .sequence_number = number,
                 .stamp_utc_ns = (kNow - age).time_since_epoch().count()},
                kNow);
}

TEST(StreamMeter, CountsWhatIsSkipped) {
  link::StreamMeter meter(2);
  for (const std::uint32_t number : {1U, 2U, 5U, 6U, 8U}) receive(meter, 0, number);
  receive(meter, 1, 40);  // counting begins with the first state received

  EXPECT_EQ(meter.counts().received, 6U);
  EXPECT_EQ(meter.counts().lost, 3U);
  EXPECT_EQ(meter.counts().gaps, 2U);
  EXPECT_EQ(meter.counts().sent(), 9U);
}

TEST(StreamMeter, DistinguishesReorderedFromDuplicatedStates) {
  link::StreamMeter meter(1);
  for (const std::uint32_t number : {1U, 4U, 2U, 2U, 4U, 3U}) receive(meter, 0, number);

  EXPECT_EQ(meter.counts().received, 4U);
  EXPECT_EQ(meter.counts().lost, 0U);
  EXPECT_EQ(meter.counts().reordered, 2U);
  EXPECT_EQ(meter.counts().duplicates, 2U);
}

TEST(StreamMeter, LetsARestartedRobotBeginAnew) {
  link::StreamMeter meter(1);
  receive(meter, 0, 1000);
  receive(meter, 0, 1);
  receive(meter, 0, 2);

  EXPECT_EQ(meter.counts().received, 3U);
  EXPECT_EQ(meter.counts().lost, 0U);
  EXPECT_EQ(meter.counts().duplicates, 0U);
}

TEST(StreamMeter, IsNotMisledByALongGap) {
  link::StreamMeter meter(1);
  receive(meter, 0, 1);
  receive(meter, 0, 1000);
  receive(meter, 0, 999);

  EXPECT_EQ(meter.counts().lost, 997U);
  EXPECT_EQ(meter.counts().reordered, 1U);
}

TEST(StreamMeter, MeasuresLatencyInAllAndSinceLastAsked) {
  link::StreamMeter meter(3);
  receive(meter, 0, 1, microseconds(100));
  receive(meter, 2, 1, microseconds(9'000));
  EXPECT_EQ(meter.take_recent_latency().count(), 2U);
  receive(meter, 0, 2, microseconds(100));
  receive(meter, 7, 1, microseconds(100'000));  // there is no such robot

  EXPECT_EQ(meter.take_recent_latency().count(), 1U);
  EXPECT_EQ(meter.latency().count(), 3U);
  EXPECT_EQ(meter.worst().robot, RobotId(2));
  EXPECT_EQ(meter.worst().latency_us, 9'000);
  EXPECT_EQ(meter.counts().strange, 1U);
}

TEST(SoakMission, MovesUntilTheTimeIsUp) {
  for (const std::uint32_t robots : {1U, 50U, 5000U}) {
    const auto mission = soak_mission(robots, 20.0, 600.0);
    ASSERT_TRUE(mission) << mission.error().message;
    EXPECT_EQ(mission->robots.count, robots);
    EXPECT_EQ(mission->control.rate_hz, 20.0);
    EXPECT_EQ(mission->launcher.time_limit_s, 600.0);
    ASSERT_FALSE(mission->script.empty());
    EXPECT_GT(mission->script.back().at_s, 600.0);
  }
}

std::vector<SoakSample> samples(const std::vector<double>& rss_mb) {
  std::vector<SoakSample> samples;
  for (const double mb : rss_mb) samples.push_back({.rss_mb = mb});
  return samples;
}

TEST(Growth, LeavesTheWarmUpOut) {
  std::vector<double> rss_mb(100, 50.0);
  std::fill_n(rss_mb.begin(), 10, 10.0);
  std::fill_n(rss_mb.end() - 10, 10, 51.0);

  const Growth growth = growth_of(samples(rss_mb), &SoakSample::rss_mb);

  EXPECT_DOUBLE_EQ(growth.start, 50.0);
  EXPECT_DOUBLE_EQ(growth.end, 51.0);
  EXPECT_DOUBLE_EQ(growth.max, 51.0);
  EXPECT_DOUBLE_EQ(growth.percent(), 2.0);
}

TEST(Growth, IsNoneOfNothingOrOneSample) {
  EXPECT_EQ(growth_of({}, &SoakSample::rss_mb).percent(), 0.0);
  EXPECT_EQ(growth_of(samples({7.0}), &SoakSample::rss_mb).percent(), 0.0);
}

SoakResult good_result() {
  SoakResult result{.processes = 2, .discovery_s = 0.3, .flown = true};
  result.measured.samples = samples(std::vector<double>(20, 50.0));
  result.measured.received = link::StreamMeter::Counts{.received = 1000};
  for (int i = 0; i < 1000; ++i) result.measured.latency.add(200);
  result.measured.states_used = 5000;
  return result;
}

constexpr SoakCriteria kStrict{.max_p99_ms = 1.0, .max_loss = 0.0, .max_rss_growth_pct = 2.0};

TEST(Soak, IsGoodWhenNothingIsBeyondItsCriteria) {
  EXPECT_TRUE(complaints(good_result(), kStrict).empty());
  EXPECT_TRUE(complaints(good_result(), {}).empty());
}

TEST(Soak, FailsByEachOfItsCriteria) {
  const auto fails = [](auto spoil) {
    SoakResult result = good_result();
    spoil(result);
    EXPECT_EQ(complaints(result, kStrict).size(), 1U);
    return complaints(result, {}).empty();
  };
  EXPECT_TRUE(fails([](SoakResult& r) {
    for (int i = 0; i < 20; ++i) r.measured.latency.add(2000);
  }));
  EXPECT_TRUE(fails([](SoakResult& r) { r.measured.latency = {}; }));
  EXPECT_TRUE(fails([](SoakResult& r) { r.measured.received->lost = 1; }));
  EXPECT_TRUE(fails([](SoakResult& r) { r.measured.receive_drops = 1; }));
  EXPECT_TRUE(fails([](SoakResult& r) { r.measured.samples.back().rss_mb = 60.0; }));
  EXPECT_FALSE(fails([](SoakResult& r) { r.collisions = 1; }));
  EXPECT_FALSE(fails([](SoakResult& r) { r.flown = false; }));
}

TEST(Soak, IsADocumentWithEveryKey) {
  const auto json = nlohmann::json::parse(to_json(good_result(), {"why"}));

  EXPECT_EQ(json["outcome"], "criteria_not_met");
  EXPECT_EQ(json["sent"], 1000);
  EXPECT_NEAR(json["latency_ms"]["p9999"].get<double>(), 0.2, 0.02);
  EXPECT_TRUE(json["use_latency_ms"].is_null());
  for (const char* key : {"discovery_s", "received", "lost", "duplicates", "reordered",
                          "deadline_miss_ratio", "cpu_s", "rss_growth_pct"}) {
    EXPECT_TRUE(json.at(key).is_number()) << key;
  }
  for (const char* key : {"start", "end", "max"}) EXPECT_TRUE(json["rss_mb"].contains(key)) << key;
}

TEST(Soak, ShowsItsCurvesAndReasons) {
  const std::string page = to_html(good_result(), {"memory grew"});

  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_NE(page.find("memory grew"), std::string::npos);
}

TEST(ProcessSample, IsThatOfThisProcess) {
  const auto before = sample_process(::getpid());
  const std::ifstream one_more("/proc/self/stat");
  std::this_thread::sleep_for(std::chrono::milliseconds(1));  // switches context
  const auto after = sample_process(::getpid());

  ASSERT_TRUE(before && after);
  EXPECT_GT(before->rss_mb, 1.0);
  EXPECT_GE(before->threads, 1U);
  EXPECT_EQ(after->open_files, before->open_files + 1);
  EXPECT_GE(after->cpu_s, before->cpu_s);
  EXPECT_GT(after->context_switches, before->context_switches);
}

TEST(ProcessSample, IsNoneOfNoProcess) { EXPECT_FALSE(sample_process(0x7FFFFFF0)); }

/// A status of the process `id` that was sent at kNow.
link::StatusMessage status(std::uint32_t id, std::uint64_t command, std::uint64_t scene) {
  return {.process_id = id,
          .plan_scene_version = scene,
          .command_id = command,
          .stamp_utc_ns = kNow.time_since_epoch().count()};
}
std::uint64_t published(Duration before) {
  return static_cast<std::uint64_t>((kNow - before).time_since_epoch().count());
}

TEST(PathMeter, MeasuresCommandsAndScenesFromTheirPublication) {
  PathMeter meter;
  for (const std::uint32_t id : {1U, 2U}) {  // what was published before the soak does not count
    meter.on_status(status(id, published(std::chrono::seconds(9)), 1), kNow);
  }
  const auto command = published(microseconds(50'000));
  const auto scene = published(microseconds(200'000));
  for (int repeated = 0; repeated < 3; ++repeated) {
    meter.on_status(status(1, command, scene), kNow + microseconds(2'000));
  }
  meter.on_status(status(2, command, scene), kNow + microseconds(2'000));

  const PathLatencies& p = meter.latencies();
  EXPECT_EQ(p.commands, 1U);
  EXPECT_EQ(p.scenes, 1U);
  EXPECT_EQ(p.command.count(), 2U);
  EXPECT_NEAR(static_cast<double>(p.command.max_us()), 50'000, 3'000);
  EXPECT_NEAR(static_cast<double>(p.plan.max_us()), 200'000, 10'000);
  EXPECT_EQ(p.status.count(), 6U);
  EXPECT_EQ(p.clock_error_us, 0);
}

TEST(PathMeter, ShowsClocksThatAreOff) {
  PathMeter meter;
  meter.on_status(status(1, 0, 0), kNow - microseconds(700));
  EXPECT_EQ(meter.latencies().clock_error_us, 700);
}

TEST(SoakResult, FailsWhereAPathIsSlowOrCarriedNothing) {
  SoakResult result{.flown = true};
  SoakCriteria criteria{.max_late_pct = 1.0,
                        .max_status_ms = 100.0,
                        .max_command_ms = 100.0,
                        .max_beat_ms = 1000.0,
                        .max_clock_error_ms = 1.0,
                        .is_flat = true};
  PathLatencies& p = result.measured.paths;
  p.status.add(50'000);
  p.command.add(300'000);
  p.clock_error_us = 2'000;
  result.measured.ticks = 100;
  result.measured.late_ticks = 2;
  for (int i = 0; i < 20; ++i) result.measured.samples.push_back({.threads = 100.0 + i});

  const auto found = complaints(result, criteria);

  ASSERT_EQ(found.size(), 5U) << ::testing::PrintToString(found);
  EXPECT_TRUE(found[0].starts_with("command p99 30")) << found[0];
  EXPECT_EQ(found[1], "longest gap of heartbeats: nothing was measured");
  EXPECT_EQ(found[2], "clock error 2.0 ms > 1 ms");
  EXPECT_EQ(found[3], "2.000 % late ticks > 1 %");
  EXPECT_TRUE(found[4].starts_with("threads grew by")) << found[4];
}

}  // namespace
}  // namespace swarm::launcher
