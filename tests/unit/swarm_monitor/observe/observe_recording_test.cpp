// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/observe/observer.hpp"
#include "tests/unit/swarm_monitor/synthetic_run.hpp"

namespace swarm::monitor {
namespace {

struct Notebook final : Observer {
  void on_mission(const Mission& mission) override { robots = mission.robots.count; }
  void on_plan(const ObservedPlan& plan) override { plans.push_back(plan.version); }
  void on_state(const ObservedState& state) override { states.push_back(state); }
  void on_event(const ObservedEvent& event) override { events.push_back(event); }
  std::uint32_t robots = 0;
  std::vector<std::uint32_t> plans;
  std::vector<ObservedState> states;
  std::vector<ObservedEvent> events;
};

TEST(ObserveRecording, ReportsStatesInTheOrderOfTheirTimes) {
  SyntheticRun files(2);
  files.write(0, {.positions_m = straight({5, 5}, {6, 5}, 10), .begin_s = 0.0});
  files.write(1, {.positions_m = straight({5, 9}, {6, 9}, 10), .begin_s = 0.55});
  Notebook notebook;

  const auto observed = observe_recording(files.dir(), notebook);

  ASSERT_TRUE(observed) << observed.error().message;
  EXPECT_EQ(notebook.robots, 2U);
  ASSERT_EQ(notebook.states.size(), 22U);
  std::uint32_t of_robot[2] = {0, 0};
  for (std::size_t i = 0; i < 22; ++i) {
    const ObservedState& state = notebook.states[i];
    EXPECT_EQ(state.sequence, ++of_robot[state.robot.value()]);
    if (i == 0) continue;
    EXPECT_GE(state.stamp, notebook.states[i - 1].stamp);
  }
  EXPECT_NEAR(notebook.states[0].velocity_mps.x(), 1.0, 1e-6);
  EXPECT_EQ(notebook.states.back().velocity_mps, Vec2::Zero());
}

TEST(ObserveRecording, ReportsPlansAndEvents) {
  SyntheticRun files(2);
  files.write_good_run();
  files.write_file("events.jsonl",
                   "{\"utc_ns\":" + std::to_string(at_s(1.5).time_since_epoch().count()) +
                       ",\"source\":\"launcher\",\"severity\":\"info\",\"code\":\"start\","
                       "\"text\":\"all are there\"}\n");
  Notebook notebook;

  ASSERT_TRUE(observe_recording(files.dir(), notebook));

  EXPECT_FALSE(notebook.states.empty());
  ASSERT_EQ(notebook.events.size(), 1U);
  EXPECT_EQ(notebook.events[0].code, "start");
}

TEST(ObserveRecording, ReportsWhatIsNoRun) {
  Notebook notebook;
  const auto observed = observe_recording("/nonexistent", notebook);
  ASSERT_FALSE(observed);
  EXPECT_NE(observed.error().message.find("/nonexistent"), std::string::npos);
}

}  // namespace
}  // namespace swarm::monitor
