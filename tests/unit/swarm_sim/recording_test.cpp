// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_sim/recording.hpp"

#include <filesystem>
#include <thread>
#include <variant>

#include <gtest/gtest.h>

#include "swarm_core/robot_log/robot_log_file.hpp"

namespace swarm::launcher {
namespace {

/// The positions, in metres, that a recording keeps of a robot that is at k m in period k.
std::vector<double> kept_m(std::uint64_t every, std::uint32_t periods) {
  Mission mission;
  mission.robots.count = 1;
  Recording recording(mission, UtcTime{}, every);
  for (std::uint32_t k = 0; k < periods; ++k) {
    recording.begin_period();
    recording.step(RobotId(0), {.stamp = UtcTime{} + k * std::chrono::milliseconds(1),
                                .position_m = {static_cast<double>(k), 0.0}});
  }
  const std::vector<monitor::Track> tracks = recording.tracks();
  std::vector<double> places_m;
  for (const monitor::TrackPoint& p : tracks[0].points) {
    places_m.push_back(p.position_m.x());
  }
  return places_m;
}

using Places = std::vector<double>;

TEST(Recording, KeepsEveryPeriod) { EXPECT_EQ(kept_m(1, 4), (Places{0, 1, 2, 3})); }

TEST(Recording, KeepsEveryNthPeriodAndTheLast) {
  EXPECT_EQ(kept_m(5, 12), (Places{0, 5, 10, 11}));
  EXPECT_EQ(kept_m(5, 11), (Places{0, 5, 10}));
  EXPECT_EQ(kept_m(Recording::kFirstAndLast, 7), (Places{0, 6}));
}

TEST(Recording, OfOnePeriodOrNone) {
  EXPECT_EQ(kept_m(5, 1), (Places{0}));
  EXPECT_EQ(kept_m(5, 0), Places{});
}

constexpr UtcTime kBegin{std::chrono::seconds(1000)};
UtcTime at(std::uint32_t period) { return kBegin + period * std::chrono::milliseconds(100); }

Mission swarm_of(std::uint32_t robots) {
  Mission mission;
  mission.robots.count = robots;
  return mission;
}

robot_log::Step step_at(std::uint32_t period) {
  return {.stamp = at(period), .position_m = {static_cast<double>(period), 1.0}};
}

// The logs of a recording as files, record by record: a letter for each kind, and for a step and a
// note the period.
std::vector<robot_log::File> written(const Recording& recording, std::uint32_t robots) {
  const std::filesystem::path run = std::filesystem::path(::testing::TempDir()) /
                                    ::testing::UnitTest::GetInstance()->current_test_info()->name();
  std::filesystem::create_directories(robot_log::file_of(run, RobotId(0)).parent_path());
  const auto result = recording.write(run);
  EXPECT_TRUE(result.has_value());
  std::vector<robot_log::File> files;
  for (std::uint32_t i = 0; i < robots; ++i) {
    files.push_back(robot_log::read_file(robot_log::file_of(run, RobotId(i))).value());
  }
  std::filesystem::remove_all(run);
  return files;
}

std::string kinds(const robot_log::File& file) {
  std::string all;
  for (const robot_log::Record& record : file.records) {
    all += "HSELN"[record.index()];
    if (const auto* note = std::get_if<robot_log::Note>(&record)) all += note->code;
  }
  return all;
}

TEST(Recording, KeepsTheOrderOfNotesAndStepsOfTheSameTime) {
  const Mission mission = swarm_of(1);
  Recording recording(mission, kBegin, 1);
  RobotRecording log(recording, RobotId(0));
  log.append(robot_log::Note{.stamp = at(0), .code = "(earlier)"});
  for (std::uint32_t k = 0; k < 3; ++k) {
    recording.begin_period();
    if (k == 1) log.append(robot_log::Note{.stamp = at(1), .code = "(before)"});
    log.append(step_at(k));
    if (k == 1) log.append(robot_log::Note{.stamp = at(1), .code = "(after)"});
    log.append(robot_log::Estimate{.stamp = at(k), .neighbour = RobotId(5)});
  }
  log.append(robot_log::Note{.stamp = at(9), .code = "(exit)"});

  EXPECT_EQ(kinds(written(recording, 1)[0]), "HN(earlier)SEN(before)SEN(after)SELN(exit)");
}

TEST(Recording, BeginsEachLogWithItsRobotAndCountsTheNetworkInTheFirst) {
  Mission mission = swarm_of(3);
  mission.robots.radius_m = 0.3;
  mission.robots.groups.resize(1);  // of one robot: the first
  mission.robots.groups[0].radius_m = 0.5;
  Recording recording(mission, kBegin, 1);
  recording.begin_period();
  for (std::uint32_t i = 0; i < 3; ++i) recording.step(RobotId(i), step_at(0));
  recording.link().states_sent = 12;
  recording.link().states_received = 34;

  const std::vector<robot_log::File> files = written(recording, 3);

  for (std::uint32_t i = 0; i < 3; ++i) {
    ASSERT_EQ(kinds(files[i]), i == 0 ? "HSL" : "HS");
    const auto& header = std::get<robot_log::Header>(files[i].records[0]);
    EXPECT_EQ(header.robot, RobotId(i));
    EXPECT_EQ(header.robots, 3U);
    EXPECT_EQ(header.stamp, kBegin);
    EXPECT_EQ(header.radius_m, i == 0 ? 0.5 : 0.3);
  }
  const auto& stats = std::get<robot_log::LinkStats>(files[0].records[2]);
  EXPECT_EQ(stats.states_sent, 12U);
  EXPECT_EQ(stats.states_received, 34U);
  EXPECT_EQ(stats.stamp, at(0));
}

TEST(Recording, StampsTheCountersOfTheNetworkThoughTheFirstRobotIsDead) {
  const Mission mission = swarm_of(2);
  Recording recording(mission, kBegin, 1);
  for (std::uint32_t k = 0; k < 5; ++k) {
    recording.begin_period();
    if (k < 2) recording.step(RobotId(0), step_at(k));
    recording.step(RobotId(1), step_at(k));
  }

  const std::vector<robot_log::File> files = written(recording, 2);

  ASSERT_EQ(kinds(files[0]), "HSSL");
  const UtcTime stamp = std::get<robot_log::LinkStats>(files[0].records[3]).stamp;
  EXPECT_GE(stamp, at(1));
  EXPECT_LE(stamp, at(4));
}

TEST(Recording, CountsUpToWhatALogHoldsAndNoFurther) {
  // 50 000 robots receive more than 2³² states within an hour.
  const Mission mission = swarm_of(1);
  Recording recording(mission, kBegin, 1);
  recording.begin_period();
  recording.step(RobotId(0), step_at(0));
  recording.link().states_sent = 4'294'967'295;
  recording.link().states_received = 4'294'967'296 + 5;

  const std::vector<robot_log::File> files = written(recording, 1);

  const auto& stats = std::get<robot_log::LinkStats>(files[0].records.at(2));
  EXPECT_EQ(stats.states_sent, 4'294'967'295);
  EXPECT_EQ(stats.states_received, 4'294'967'295);
}

TEST(Recording, HasTheLastTwoStepsOfARobotThatDied) {
  const Mission mission = swarm_of(3);
  Recording recording(mission, kBegin, 1);
  EXPECT_TRUE(recording.last_steps(RobotId(0)).empty());
  for (std::uint32_t k = 0; k < 6; ++k) {
    recording.begin_period();
    recording.step(RobotId(0), step_at(k));
    if (k < 3) recording.step(RobotId(1), step_at(k));
    if (k == 4) recording.step(RobotId(2), step_at(k));
  }

  const auto periods = [&](std::uint32_t robot) {
    std::vector<double> all;
    for (const robot_log::Step& step : recording.last_steps(RobotId(robot))) {
      all.push_back(step.position_m.x());
    }
    return all;
  };
  EXPECT_EQ(periods(0), (Places{4, 5}));
  EXPECT_EQ(periods(1), (Places{1, 2}));
  EXPECT_EQ(periods(2), (Places{4}));
}

TEST(Recording, IsTheSameWhenSeveralThreadsRecord) {
  constexpr std::uint32_t kRobots = 8;
  const Mission mission = swarm_of(kRobots);
  const auto record = [](Recording& recording, std::uint32_t robot, std::uint32_t period) {
    RobotRecording log(recording, RobotId(robot));
    if (period % 7 == robot) log.append(robot_log::Note{.stamp = at(period), .code = "note"});
    log.append(step_at(period));
    log.append(robot_log::Estimate{.stamp = at(period), .neighbour = RobotId(period)});
  };
  Recording alone(mission, kBegin, 3);
  Recording together(mission, kBegin, 3);
  for (std::uint32_t k = 0; k < 40; ++k) {
    alone.begin_period();
    together.begin_period();
    for (std::uint32_t i = 0; i < kRobots; ++i) record(alone, i, k);
    std::thread half([&] {
      for (std::uint32_t i = 0; i < kRobots; i += 2) record(together, i, k);
    });
    for (std::uint32_t i = 1; i < kRobots; i += 2) record(together, i, k);
    half.join();
  }

  const std::vector<monitor::Track> expected = alone.tracks();
  const std::vector<monitor::Track> tracks = together.tracks();

  ASSERT_EQ(tracks.size(), kRobots);
  for (std::uint32_t i = 0; i < kRobots; ++i) {
    EXPECT_EQ(tracks[i].points.size(), expected[i].points.size());
    EXPECT_EQ(tracks[i].estimates.size(), expected[i].estimates.size());
    EXPECT_EQ(tracks[i].notes.size(), expected[i].notes.size());
    EXPECT_EQ(tracks[i].points.back().position_m.x(), 39.0);
    EXPECT_EQ(tracks[i].estimates.size(), 14U) << "in every third of 40 periods";
  }
}

}  // namespace
}  // namespace swarm::launcher
