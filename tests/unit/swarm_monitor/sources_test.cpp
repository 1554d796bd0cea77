// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "swarm_core/robot_log/writer.hpp"
#include "swarm_link/cdr/codec.hpp"
#include "swarm_link/to_message.hpp"
#include "swarm_monitor/recording/replay.hpp"
#include "swarm_monitor/view/live_source.hpp"
#include "swarm_monitor/view/recorded_source.hpp"
#include "swarm_monitor/view/remote_control.hpp"
#include "swarm_monitor/view/top_text.hpp"
#include "swarmflow/mission/mission_file.hpp"
#include "synthetic_run.hpp"

namespace swarm::monitor {
namespace {

Mission small_mission() {
  return load_mission(std::string(SWARM_SOURCE_DIR) + "/deploy/missions/small.yaml").value();
}

struct ShownRobot {
  float x_m = 0, y_m = 0;
  int flags = 0;
};

/// The robots of a picture, by PROTOCOL.md.
std::vector<ShownRobot> robots_in(const std::vector<std::byte>& view_frame) {
  std::uint32_t n = 0;
  std::memcpy(&n, view_frame.data() + 4, sizeof n);
  std::vector<ShownRobot> robots(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::byte* robot = view_frame.data() + 24 + 16 * i;
    std::memcpy(&robots[i].x_m, robot, sizeof(float));
    std::memcpy(&robots[i].y_m, robot + 4, sizeof(float));
    robots[i].flags = std::to_integer<int>(robot[14]);
  }
  return robots;
}

UtcTime at_ms(std::int64_t ms) { return UtcTime(std::chrono::milliseconds(ms)); }

std::uint32_t topic_named(const std::string& name) {
  const auto& topics = recorded_topics();
  const auto it = std::find_if(topics.begin(), topics.end(),
                               [&](const RecordedTopic& topic) { return topic.name == name; });
  EXPECT_NE(it, topics.end()) << name;
  return static_cast<std::uint32_t>(it - topics.begin());
}

/// A bus that delivers what a test puts on it.
class FakeTap final : public BusTap {
 public:
  template <class M>
  void send_text(const std::string& topic, const M& message, UtcTime received) {
    std::vector<std::byte> bytes;
    ASSERT_TRUE(link::encode(message, bytes));
    const auto* begin = reinterpret_cast<const unsigned char*>(bytes.data());
    samples_.push_back({topic_named(topic), received, {begin, begin + bytes.size()}});
  }
  void send_state(std::uint32_t robot, std::uint32_t number, Vec2 at, Vec2 velocity,
                  UtcTime received) {
    link::CellStatesMessage batch;
    batch.states.push_back({.robot_id = robot,
                            .sequence_number = number,
                            .stamp_utc_ns = received.time_since_epoch().count(),
                            .x_m = at.x(),
                            .y_m = at.y(),
                            .vx_mps = velocity.x(),
                            .vy_mps = velocity.y(),
                            .mode = RobotMode::kMoving});
    send_text("swarm/cell", batch, received);
  }

  void take(Duration, const Sink& sink) override {
    for (const Sample& s : samples_) {
      sink({.topic = s.topic, .received = s.received, .sent = s.received, .bytes = s.bytes});
    }
    samples_.clear();
  }
  bool receives_anything() const override { return true; }

 private:
  struct Sample {
    std::uint32_t topic;
    UtcTime received;
    std::vector<unsigned char> bytes;
  };
  std::vector<Sample> samples_;
};

class Live : public testing::Test {
 protected:
  std::vector<ShownRobot> shown() {
    std::vector<std::byte> bytes;
    source_.view_frame({}, {}, bytes);
    return robots_in(bytes);
  }

  FakeTap* tap_ = new FakeTap;
  LiveSource source_{small_mission(),
                     {.channel = Channel::kGroups, .is_replay = true},
                     std::unique_ptr<BusTap>(tap_),
                     true};
};

TEST_F(Live, CarriesRobotsOnFromTheirLastState) {
  tap_->send_state(3, 1, {10, 10}, {1, 0}, at_ms(1000));
  source_.poll(at_ms(1000));
  source_.poll(at_ms(1500));

  const auto robots = shown();
  ASSERT_EQ(robots.size(), 12U);
  EXPECT_NEAR(robots[3].x_m, 10.5, 1e-5);
  EXPECT_EQ(robots[3].flags, 1);
  EXPECT_EQ(robots[2].flags, 0);
}

TEST_F(Live, MarksRobotsWithoutUpdatesAsLost) {
  tap_->send_state(3, 1, {10, 10}, {1, 0}, at_ms(1000));
  source_.poll(at_ms(1000));
  source_.poll(at_ms(4100));

  EXPECT_EQ(shown()[3].flags, 1 | 4);
  EXPECT_EQ(source_.state().counts(at_ms(4100)).lost, 1U);
}

TEST_F(Live, CountsWhatIsMissingAndWhatIsRefused) {
  tap_->send_state(3, 1, {10, 10}, {1, 0}, at_ms(1000));
  tap_->send_state(3, 4, {10, 10}, {1, 0}, at_ms(1100));
  tap_->send_state(99, 1, {10, 10}, {1, 0}, at_ms(1100));
  tap_->send_state(3, 5, {NAN, 10}, {1, 0}, at_ms(1200));
  source_.poll(at_ms(1200));

  EXPECT_EQ(source_.state().meter().counts().lost, 2U);
  EXPECT_EQ(source_.state().refused().total(), 2U);
  EXPECT_NE(source_.metrics().find("swarm_states_lost_total 2\n"), std::string::npos);
}

TEST_F(Live, ShowsAPlanAsSoonAsItIsThere) {
  ASSERT_EQ(source_.scenes().size(), 1U);
  EXPECT_TRUE(nlohmann::json::parse(source_.scenes().back())["plan"].is_null());
  const Mission mission = small_mission();
  std::vector<PlanNode> nodes{{mission.start.components()[0].gaussian, MissionTime(0), 1.0},
                              {mission.goal.components()[0].gaussian, MissionTime(20), 1.0}};
  const auto plan = FlowPlan::make(nodes, {{.from = 0, .to = 1, .mass = 1.0}}).value();
  link::PlanMessage message = link::to_message(plan, PlannerEpoch(1), PlanVersion(1), at_ms(0));
  message.excess_m = 0.25;
  tap_->send_text("swarm/plan", message, at_ms(1000));
  tap_->send_text("swarm/heartbeat",
                  link::HeartbeatMessage{.phase = MissionPhase::kRunning,
                                         .version = 1,
                                         .epoch = 1,
                                         .sequence_number = 1,
                                         .stamp_utc_ns = 1,
                                         .mission_time_s = 12.0,
                                         .plan_time_s = 10.0},
                  at_ms(1000));
  source_.poll(at_ms(1000));

  const auto scene = nlohmann::json::parse(source_.scenes().back());
  EXPECT_EQ(scene["plan"]["legs"].size(), 1U);
  EXPECT_EQ(scene["plan_excess_m"], 0.25);
  EXPECT_TRUE(scene["control"]);
  std::vector<std::byte> bytes;
  source_.view_frame({}, {}, bytes);
  // Head, robots, then one component half-way between start and goal.
  float mean_x = 0;
  std::memcpy(&mean_x, bytes.data() + 24 + 12 * 16, sizeof mean_x);
  EXPECT_NEAR(mean_x, 0.5 * (6 + 33), 1e-4);
}

TEST_F(Live, ReportsEventsOnce) {
  tap_->send_text("swarm/event",
                  link::EventMessage{.severity = link::Severity::kWarning,
                                     .source = link::kLauncherSource,
                                     .stamp_utc_ns = 5,
                                     .code = "agent-exit",
                                     .text = "robot 3 ended"},
                  at_ms(10));
  source_.poll(at_ms(10));
  source_.poll(at_ms(20));

  ASSERT_EQ(source_.events().size(), 1U);
  const auto event = nlohmann::json::parse(source_.events().front());
  EXPECT_EQ(event["source"], "launcher");
  EXPECT_EQ(event["severity"], "warning");
  // Without a heartbeat the mission time of the event is unknown.
  const std::string text = top_text(source_.state(), {.name = "small"}, at_ms(20));
  EXPECT_NE(text.find(" –  launcher  agent-exit: robot 3 ended"), std::string::npos) << text;
}

TEST_F(Live, IsShownInATerminal) {
  tap_->send_state(3, 1, {10, 10}, {1, 0}, at_ms(1000));
  source_.poll(at_ms(1000));

  const std::string text = top_text(source_.state(), {.name = "small"}, at_ms(1000));

  EXPECT_NE(text.find("1 of 12 robots received  1 moving"), std::string::npos) << text;
  EXPECT_NE(text.find("     3  moving      10.00    10.00    1.00"), std::string::npos) << text;
}

TEST(Recorded, IsShownAtAnyTime) {
  SyntheticRun files(2);
  files.write(0, {.positions_m = straight({5, 5}, {15, 5}, 100), .process_id = 1});
  files.write(1, {.positions_m = straight({5, 15}, {5, 15}, 50), .graceful = false});
  RecordedSource source(read_run(files.dir()).value());
  const auto shown = [&](double time_s) {
    std::vector<std::byte> bytes;
    source.view_frame(time_s, {}, bytes);
    return robots_in(bytes);
  };

  EXPECT_NEAR(shown(5.03)[0].x_m, 5 + 5.03, 1e-4);  // between two steps
  EXPECT_NEAR(shown(-3)[0].x_m, 5, 1e-4);
  EXPECT_NEAR(shown(99)[0].x_m, 15, 1e-4);
  EXPECT_EQ(shown(5.0)[1].flags & 4, 0);
  EXPECT_EQ(shown(9.0)[1].flags & 4, 4);  // its log ended at 5 s without the note "exit"
  const auto scene = nlohmann::json::parse(source.scenes().front());
  EXPECT_FALSE(scene["live"]);
  EXPECT_NEAR(scene["end"].get<double>(), 10.0, 1e-9);
  EXPECT_EQ(source.series().size(), 11U);
}

TEST(RemoteControl, UsesTheLaunchersCommands) {
  const Mixture goal = small_mission().goal;
  EXPECT_EQ(command_line_of({.action = ControlAction::kPause}, goal), "pause");
  EXPECT_EQ(command_line_of(
                {.action = ControlAction::kAddObstacle, .x_m = 1, .y_m = 2, .radius_m = 0.5}, goal),
            "add_obstacle circle_m: {center: [1, 2], radius: 0.5}");
  const std::string moved =
      command_line_of({.action = ControlAction::kGoal, .x_m = 20, .y_m = 10}, goal);
  // Two components at (33, 22) and (33, 9), half each: their mean is (33, 15.5).
  EXPECT_EQ(moved.find("goto goal: [{mean_m: [20, 16.5]"), 0U) << moved;
}

TEST(Score, KeepsEveryTopicsOrderAndTimes) {
  const auto file = std::filesystem::temp_directory_path() / "sources_test_score.mcap";
  std::filesystem::remove(file);
  {
    auto writer = mcap::Writer::create(file).value();
    const auto& topics = recorded_topics();
    const auto plan = writer.add_channel("swarm/plan", topics[topic_named("swarm/plan")].schema);
    const auto beat =
        writer.add_channel("swarm/heartbeat", topics[topic_named("swarm/heartbeat")].schema);
    const auto other = writer.add_channel("other", {.name = "Other", .encoding = "omgidl"});
    const std::vector<unsigned char> data{0, 1, 0, 0};
    const auto send_text = [&](std::uint16_t channel, std::int64_t sent_s) {
      writer.write(channel, 20'000'000'000, sent_s * 1'000'000'000, data);
    };
    send_text(plan, 10);
    send_text(other, 10);
    send_text(beat, 12);
    send_text(beat, 11);  // its writer's clock stepped back
    send_text(beat, 14);
  }

  const auto all = read_score(file, 0.0, {}).value();
  ASSERT_EQ(all.messages.size(), 4U);
  EXPECT_EQ(all.foreign, 1U);
  EXPECT_EQ(all.messages[1].at, std::chrono::seconds(2));
  EXPECT_EQ(all.messages[2].at, std::chrono::seconds(2));
  EXPECT_EQ(all.messages[3].at, std::chrono::seconds(4));

  const auto later = read_score(file, 3.0, {}).value();
  ASSERT_EQ(later.messages.size(), 2U);  // the latched plan first
  EXPECT_EQ(later.messages[0].topic, topic_named("swarm/plan"));
  EXPECT_EQ(later.messages[0].at, Duration(0));
  EXPECT_EQ(later.messages[1].at, std::chrono::seconds(1));

  EXPECT_EQ(read_score(file, 0.0, {"swarm/plan"}).value().messages.size(), 1U);
  EXPECT_FALSE(read_score(file, 0.0, {"nothing/"}));
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace swarm::monitor
