// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A hostile participant publishes invalid messages on the bus of a flying swarm. (Samples that only
// a foreign writer can make, too long for the contract, are in tests/conformance.)
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "swarm_link/topics.hpp"
#include "tests/system/hostile/intruder.hpp"

namespace swarm::test {
namespace {

using namespace swarm::link;

/// A well-formed plan of one leg; every test case spoils it in one way.
PlanMessage decent_plan() {
  const PlanNodeMessage from{.mean_x_m = 10,
                             .mean_y_m = 10,
                             .covariance_xx_m2 = 4,
                             .covariance_yy_m2 = 4,
                             .time_s = 0,
                             .mass = 1};
  PlanNodeMessage to = from;
  to.mean_x_m = 30;
  to.time_s = 10;
  return {.version = 1,
          .epoch = static_cast<std::uint64_t>(utc_ns()),
          .nodes = {from, to},
          .legs = {{0, 1, 1.0}}};
}

CellStatesMessage decent_batch(std::uint32_t robot, const Cell& cell) {
  static std::uint32_t sequence = 1'000'000;
  return {.cell_x = cell.x,
          .cell_y = cell.y,
          .states = {{.robot_id = robot,
                      .sequence_number = ++sequence,
                      .stamp_utc_ns = utc_ns(),
                      .x_m = 10,
                      .y_m = 10}}};
}

/// The state of a run by its bus: the planner's phase and how many robots are in a mode.
class Onlooker {
 public:
  explicit Onlooker(Participant& participant)
      : participant_(participant),
        heartbeats_(participant.make_reader(heartbeat_topic()).value()),
        statuses_(participant.make_reader(status_topic()).value()) {}

  void look() {
    participant_.receive();
    std::vector<HeartbeatMessage> beats;
    heartbeats_->take(beats);
    for (const HeartbeatMessage& beat : beats) phase_ = beat.phase;
    std::vector<StatusMessage> statuses;
    statuses_->take(statuses);
    for (const StatusMessage& status : statuses) {
      for (const RobotStatusMessage& robot : status.robots) modes_[robot.robot_id] = robot.mode;
    }
  }
  std::optional<MissionPhase> phase() const { return phase_; }
  long robots_in(RobotMode mode) const {
    return std::count_if(modes_.begin(), modes_.end(),
                         [&](const auto& robot) { return robot.second == mode; });
  }

 private:
  Participant& participant_;
  ReaderPtr<HeartbeatMessage> heartbeats_;
  ReaderPtr<StatusMessage> statuses_;
  std::optional<MissionPhase> phase_;
  std::map<std::uint32_t, RobotMode> modes_;
};

/// The sources of the events with this text.
std::set<std::string> reporters_of(const FlownRun& run, const std::string& text) {
  std::set<std::string> reporters;
  std::istringstream lines(read_text(run.dir() / "events.jsonl"));
  for (std::string line; std::getline(lines, line);) {
    const auto event = nlohmann::json::parse(line, nullptr, false);
    if (event.is_object() && event["text"] == text) reporters.insert(event["source"]);
  }
  return reporters;
}

// Ids of commands are UTC stamps. One near 2^64, if accepted, would outrank all later commands.
TEST(HostileBus, ACommandWithAHugeIdLocksNoOtherSenderOut) {
  constexpr std::size_t kRobots = 12;
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  auto participant = intrude(run);
  ASSERT_TRUE(participant.has_value()) << participant.error().message;
  Onlooker onlooker(**participant);
  const auto is_running = [&] {
    onlooker.look();
    return onlooker.phase() == MissionPhase::kRunning && onlooker.robots_in(RobotMode::kMoving) > 0;
  };
  const auto is_paused = [&] {
    onlooker.look();
    return onlooker.phase() == MissionPhase::kPaused &&
           onlooker.robots_in(RobotMode::kMoving) == 0 &&
           onlooker.robots_in(RobotMode::kHolding) > 0;
  };
  const auto commands = (*participant)->make_writer(command_topic()).value();
  ASSERT_TRUE(eventually(
      [&] { return is_running() && commands->matched() >= static_cast<int>(kRobots) + 1; }));

  commands->write(
      {.kind = CommandKind::kPause, .command_id = std::numeric_limits<std::uint64_t>::max()});

  ASSERT_TRUE(eventually([&] {
    return reporters_of(run, "1 message(s): forged").size() == kRobots + 1;
  })) << read_text(run.dir() / "events.jsonl");
  EXPECT_TRUE(is_running()) << "the forged pause was obeyed";

  Program pause("swarm_launcher", {"command", run.dir().string(), "pause"});
  EXPECT_EQ(pause.wait(), 0) << pause.err();
  EXPECT_TRUE(eventually(is_paused));

  Program resume("swarm_launcher", {"command", run.dir().string(), "resume"});
  EXPECT_EQ(resume.wait(), 0) << resume.err();
  EXPECT_TRUE(eventually(is_running));

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_EQ(run.summary()["arrived"], 12);
}

TEST(HostileBus, RubbishIsRefusedCountedAndHarmless) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  auto participant = intrude(run);
  ASSERT_TRUE(participant.has_value()) << participant.error().message;
  auto plans = (*participant)->make_writer(plan_topic());
  auto heartbeats = (*participant)->make_writer(heartbeat_topic());
  auto commands = (*participant)->make_writer(command_topic());
  ASSERT_TRUE(plans && heartbeats && commands);
  std::vector<WriterPtr<CellStatesMessage>> cells;
  std::vector<Cell> where;
  for (int x = 0; x < 3; ++x) {
    for (int y = 0; y < 2; ++y) {
      where.push_back({x, y});
      auto writer = (*participant)->make_writer(cell_topic({x, y}));
      ASSERT_TRUE(writer.has_value());
      cells.push_back(std::move(*writer));
    }
  }
  ASSERT_TRUE(
      eventually([&] { return (*plans)->matched() >= 12 && (*commands)->matched() >= 12; }));

  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::function<void(PlanMessage&)>> spoiled_plans = {
      [&](PlanMessage& p) { p.nodes[1].mean_x_m = nan; },
      [](PlanMessage& p) { p.nodes[0].covariance_xy_m2 = 100; },  // not positive definite
      [](PlanMessage& p) { p.nodes[1].mass = p.legs[0].mass = 7; },
      [](PlanMessage& p) { p.schema_version = 99; },
      [](PlanMessage& p) { p.legs[0].to_node = 4000; },
      [](PlanMessage& p) { p.epoch = 1; },  // stale
      [](PlanMessage& p) {
        p.epoch = std::numeric_limits<std::uint64_t>::max();
      },  // from the future
  };
  for (const auto& spoil : spoiled_plans) {
    PlanMessage plan = decent_plan();
    spoil(plan);
    (*plans)->write(plan);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // keep-last 1: let each be taken
  }
  const std::vector<std::function<void(RobotStateMessage&)>> spoiled_states = {
      [&](RobotStateMessage& s) { s.x_m = nan; },
      [](RobotStateMessage& s) { s.x_m = 1e7; },
      [](RobotStateMessage& s) { s.vx_mps = 50; },
      [](RobotStateMessage& s) { s.robot_id = 4'000'000'000; },
      [](RobotStateMessage& s) { s.stamp_utc_ns -= 60'000'000'000; },
      [](RobotStateMessage& s) { s.mode = static_cast<RobotMode>(200); },
  };
  for (int round = 0; round < 20; ++round) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      for (const auto& spoil : spoiled_states) {
        CellStatesMessage batch = decent_batch(3, where[i]);
        spoil(batch.states[0]);
        cells[i]->write(batch);
      }
      for (std::uint32_t robot = 0; robot < 12; ++robot) {
        CellStatesMessage impostor = decent_batch(robot, where[i]);
        impostor.states[0].x_m = 39;  // far from all robots: harmless even if accepted
        impostor.states[0].y_m = 29;
        cells[i]->write(impostor);
      }
    }
    (*heartbeats)
        ->write({.epoch = std::numeric_limits<std::uint64_t>::max(), .sequence_number = 1});
    (*heartbeats)->write({.epoch = 5, .sequence_number = 1, .mission_time_s = nan});
    (*commands)->write(
        {.kind = static_cast<CommandKind>(77), .command_id = static_cast<std::uint64_t>(utc_ns())});
    (*commands)->write({.kind = CommandKind::kPause, .command_id = 1});
    (*commands)->write(
        {.kind = CommandKind::kPause, .command_id = std::numeric_limits<std::uint64_t>::max()});
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  const auto summary = run.summary();
  EXPECT_EQ(summary["arrived"], 12);
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_GT(summary["refused_messages"], 100);
  const std::string events = read_text(run.dir() / "events.jsonl");
  for (const char* reason : {"not-finite", "bad-gaussian", "bad-mass", "schema", "out-of-range",
                             "stale", "clock-skew", "forged"}) {
    EXPECT_NE(events.find(std::string("message(s): ") + reason), std::string::npos) << reason;
  }
}

}  // namespace
}  // namespace swarm::test
