// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Processes that hang, and senders that flood the launcher.
#include <algorithm>
#include <chrono>
#include <string>
#include <thread>

#include "swarm_link/event_names.hpp"
#include "swarm_link/udp_socket.hpp"
#include "tests/unit/swarm_launcher/flight/flight_bench.hpp"

namespace swarm::launcher {
namespace {

class FlightLoopSilence : public FlightBench {
 protected:
  /// Heartbeats of the planner that runs arrive during this time.
  void fly_with_heartbeats(Duration span) {
    for (const SteadyTime until = now.steady + span; now.steady < until;
         run_for(milliseconds(200))) {
      others.heartbeats->write({.epoch = kEpoch + planners(),
                                .sequence_number = ++beats,
                                .stamp_utc_ns = now.utc.time_since_epoch().count()});
    }
  }
  std::size_t planners() const {
    return static_cast<std::size_t>(std::ranges::count_if(
        spawner.children, [](const FakeChild& child) { return child.is_planner(); }));
  }
  std::size_t logged(const std::string& code) const {
    const auto text = shell::read_file(dir.path / shell::kEventsFile, 1U << 24U).value_or("");
    const std::string wanted = "\"code\":\"" + code + "\"";
    std::size_t lines = 0;
    for (std::size_t at = 0; (at = text.find(wanted, at)) != std::string::npos; ++at) ++lines;
    return lines;
  }

  static constexpr std::uint64_t kEpoch = 1'799'999'000'000'000'000ULL;  // 1000 s ago
  std::uint64_t beats = 0;
};

TEST_F(FlightLoopSilence, RestartsAPlannerThatHangs) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  fly_with_heartbeats(seconds(2));
  spawner.obedient = false;
  run_for(milliseconds(9500));
  EXPECT_TRUE(is_logged("planner-silent"));
  EXPECT_EQ(planners(), 1U);
  run_for(seconds(2));
  EXPECT_EQ(spawner.children.front().signals, std::vector{EndSignal::kKill});
  EXPECT_EQ(planners(), 2U);

  fly_with_heartbeats(seconds(15));
  EXPECT_EQ(planners(), 2U);
  EXPECT_EQ(logged("planner-silent"), 1U);
  EXPECT_EQ(logged("silent-killed"), 1U);
}

TEST_F(FlightLoopSilence, KillsAnAgentThatHangsAndRestartsIt) {
  options.mission.launcher.respawn_agent_max = 1;
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  robots[1].silent = true;
  run_for(seconds(4));
  EXPECT_TRUE(is_logged("agent-silent"));
  run_for(seconds(7));
  robots[1].silent = false;
  run_for(seconds(1));
  EXPECT_TRUE(is_logged("respawn"));
  EXPECT_TRUE(loop->supervisor().lost().empty());
  EXPECT_EQ(spawner.children.size(), 2U + kRobots);
}

TEST_F(FlightLoopSilence, LogsAFloodOfEventsAtALimitedRateAndReportsTheRest) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  for (int i = 0; i < 1000; ++i) {
    others.events->write({.source = 1, .code = "flood", .text = "again"});
    if (i % 50 == 0) run_for(milliseconds(20));
  }
  run_for(seconds(1));
  EXPECT_GE(logged("flood"), 200U);
  EXPECT_LE(logged("flood"), 220U);
  EXPECT_GE(logged("events-dropped"), 1U);
}

TEST_F(FlightLoopSilence, DisplaysADuplicateIdOnce) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  for (int i = 0; i < 2; ++i) {
    others.events->write({.source = 2, .code = std::string(link::kDuplicateId), .text = "x"});
    run_for(milliseconds(100));
  }
  EXPECT_EQ(logged("duplicate-id"), 2U);
  const std::string shown = "robot-2: its process receives states under an id of its own";
  const auto first = display.printed.find(shown);
  ASSERT_NE(first, std::string::npos) << display.printed;
  EXPECT_EQ(display.printed.find(shown, first + 1), std::string::npos);
}

// A gateway that was restarted is matched with the robots behind it one by one. Until then two
// robots that are well may not receive each other.
TEST_F(FlightLoopSilence, StatesWhoIsWellOnlyWhileTheGatewayReceivesTheRobotsBehindIt) {
  if (!link::carries_multicast()) GTEST_SKIP() << "loopback carries no multicast here";
  const auto receiver = *link::StopReceiver::open({.domain = 217});
  beat_sender.emplace(*link::StopSender::open({.domain = 217}), 77);
  options.how.by_gateway = 2;
  const auto lists_all = [&] {
    receiver->take();  // those of before
    run_for(milliseconds(600));
    for (int i = 0; i < 5000; ++i) {
      receiver->take();
      if (!receiver->beats().empty()) return receiver->beats().back().lists_all;
      std::this_thread::sleep_for(milliseconds(1));
    }
    ADD_FAILURE() << "no beat";
    return false;
  };
  helpers.by_gateway = 2;
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));

  EXPECT_TRUE(lists_all());
  helpers.by_gateway = 1;
  EXPECT_FALSE(lists_all());
  robots[1].silent = true;
  run_for(seconds(4));
  EXPECT_TRUE(lists_all()) << "the launcher does not receive that one either";
  helpers.by_gateway = 0;
  EXPECT_FALSE(lists_all()) << "it does not run";
}

TEST_F(FlightLoopSilence, LogsWhatHelpersReport) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  helpers.next_events = {{.code = "gateway-restarted", .text = "x"}};
  run_for(milliseconds(100));
  EXPECT_TRUE(is_logged("gateway-restarted"));
}

}  // namespace
}  // namespace swarm::launcher
