// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The wall clock of the host is set while robots fly.
#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "experiments/chaos/stepped_clock.hpp"
#include "swarm_core/robot_log/robot_log_file.hpp"
#include "tests/system/flown_run.hpp"

namespace swarm::test {
namespace {

/// When a robot began to hold, and the longest time from one of its log's steps to the next.
struct Flown {
  std::vector<UtcTime> holds;
  Duration longest_gap{};
  bool is_in_order = true;
};
Flown read_log(const std::filesystem::path& run_dir, std::uint32_t robot) {
  Flown flown;
  std::optional<UtcTime> last;
  const auto read = robot_log::read_records(
      robot_log::file_of(run_dir, RobotId(robot)), [&](const robot_log::Record& record) {
        if (const auto* note = std::get_if<robot_log::Note>(&record)) {
          if (note->code == "mode" && note->text == "holding") flown.holds.push_back(note->stamp);
        } else if (const auto* step = std::get_if<robot_log::Step>(&record)) {
          if (last) flown.longest_gap = std::max(flown.longest_gap, step->stamp - *last);
          if (last && step->stamp < *last) flown.is_in_order = false;
          last = step->stamp;
        }
      });
  EXPECT_TRUE(read) << read.error().message;
  return flown;
}

/// When the launcher published each pause.
std::vector<UtcTime> pauses_of(const std::filesystem::path& run_dir) {
  std::vector<UtcTime> pauses;
  std::istringstream events(read_text(run_dir / "events.jsonl"));
  for (std::string line; std::getline(events, line);) {
    const auto event = nlohmann::json::parse(line);
    if (event["code"] != "command" || event["text"] != "pause") continue;
    pauses.emplace_back(Duration(event["utc_ns"].get<std::int64_t>()));
  }
  return pauses;
}

/// From a pause to the robot's first hold after it; empty if there is none.
std::optional<Duration> time_to_hold(const Flown& flown, UtcTime pause) {
  const auto hold = std::find_if(flown.holds.begin(), flown.holds.end(),
                                 [&](UtcTime stamp) { return stamp >= pause; });
  if (hold == flown.holds.end()) return std::nullopt;
  return *hold - pause;
}

/// Programs that are started by a test have a clock of their own.
class ClockStep : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    auto made = launcher::SteppedClock::make(folder_.path() / "offset");
    if (!made) GTEST_SKIP() << made.error().message;
    clock_ = *std::move(made);
  }
  /// As an absolute offset.
  void set_clock_s(std::int64_t offset_s) {
    clock_->step(offset_s - offset_s_);
    offset_s_ = offset_s;
  }

 private:
  TemporaryFolder folder_;
  std::unique_ptr<launcher::SteppedClock> clock_;
  std::int64_t offset_s_ = 0;
};

// Commands, plans, scenes and heartbeats of before a step do not outrank those after it.
TEST_P(ClockStep, ChangesNothingInFlight) {
  FlownRun run({"--channel", GetParam()});
  ASSERT_TRUE(run.mission_started()) << run.outcome();
  const auto command = [&](const std::vector<std::string>& arguments) {
    std::vector<std::string> line = {"command", run.dir().string()};
    line.insert(line.end(), arguments.begin(), arguments.end());
    Program program("swarm_launcher", line);
    EXPECT_EQ(program.wait(), 0) << arguments.front() << ": " << program.out() << program.err();
  };
  bool planner_killed = false;
  constexpr std::array<std::int64_t, 5> kSteps_s = {-8, -60, 3600, -3600, 60};
  for (const std::int64_t step_s : kSteps_s) {
    set_clock_s(step_s);
    command({"pause"});
    std::this_thread::sleep_for(std::chrono::milliseconds(500));  // each robot holds for some ticks
    command({"resume"});
    if (planner_killed) continue;
    planner_killed = true;
    ASSERT_EQ(run.planners().size(), 1U);
    ::kill(run.planners().front(), SIGKILL);
    command({"add_obstacle", "circle_m: {center: [10, 19], radius: 0.3}"});
  }

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();

  const auto summary = run.summary();
  EXPECT_EQ(summary["arrived"], 12);
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_EQ(summary["collisions_obstacle"], 0);
  EXPECT_TRUE(exists(run.dir() / "plan-0002.json")) << "of the restarted planner";
  EXPECT_LT(summary["mission_s"].get<double>(), 300.0) << "not by the wall clock";
  const std::vector<UtcTime> pauses = pauses_of(run.dir());
  ASSERT_EQ(pauses.size(), kSteps_s.size());
  Duration longest{};
  for (std::uint32_t robot = 0; robot < 12; ++robot) {
    const Flown flown = read_log(run.dir(), robot);
    for (const UtcTime pause : pauses) {
      const auto taken = time_to_hold(flown, pause);
      EXPECT_TRUE(taken) << robot;
      longest = std::max(longest, taken.value_or(Duration{}));
    }
    EXPECT_TRUE(flown.is_in_order) << robot;
    EXPECT_LT(flown.longest_gap, std::chrono::seconds(40)) << robot << ": not by the wall clock";
  }
  std::printf("from a pause to the last robot's hold: at most %.3f s\n", to_seconds(longest));
}

// A stop is obeyed whatever its stamp: also the hosts' clocks may differ.
TEST_P(ClockStep, DelaysNoEmergencyStop) {
  FlownRun run({"--channel", GetParam()});
  ASSERT_TRUE(run.mission_started()) << run.outcome();
  set_clock_s(-20);

  Program stop("swarm_launcher", {"command", run.dir().string(), "stop"});

  EXPECT_EQ(stop.wait(), 0) << stop.err();
  EXPECT_NE(stop.out().find("12 robots confirmed"), std::string::npos) << stop.out();
  EXPECT_EQ(run.launcher().wait(), 1);
  EXPECT_EQ(run.summary()["outcome"], "stopped");
}

INSTANTIATE_TEST_SUITE_P(Channels, ClockStep, testing::Values("topics", "groups"));

}  // namespace
}  // namespace swarm::test
