// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/beat_sender.hpp"

#include <chrono>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_link/udp_socket.hpp"

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;

FlightTime time(int ms) {
  return {.steady = SteadyTime(std::chrono::hours(1) + milliseconds(ms)),
          .utc = UtcTime(std::chrono::hours(2) + milliseconds(ms))};
}
SteadyTime at(int ms) { return time(ms).steady; }

TEST(BeatSender, SendsTwiceASecondAndListsTheRobotsThatAreNotReceived) {
  if (!link::carries_multicast()) GTEST_SKIP() << "loopback carries no multicast here";
  const auto robots = *link::StopReceiver::open({.domain = 218});
  Supervisor supervisor({.robots = 5, .launcher = {}, .script = {}}, at(0));
  BeatSender sut(*link::StopSender::open({.domain = 218}), 77);
  supervisor.on_status(RobotId(3), {});

  LateRobots late(5, 1.0);
  late.on_status(RobotId(3), {4.0, 2.0}, at(-600), at(-500));

  for (int ms = 0; ms <= 1000; ms += 20) sut.step(time(ms), supervisor, late);

  std::vector<link::LauncherBeat> beats;
  for (int i = 0; i < 5000 && beats.size() < 3; ++i) {
    robots->take();
    beats.insert(beats.end(), robots->beats().begin(), robots->beats().end());
    std::this_thread::sleep_for(milliseconds(1));
  }
  ASSERT_EQ(beats.size(), 3U);
  for (std::size_t i = 0; i < beats.size(); ++i) {
    EXPECT_EQ(beats[i].run, 77U);
    EXPECT_EQ(beats[i].sequence, i + 1);
    ASSERT_EQ(beats[i].silent().size(), 2U);
    EXPECT_EQ(beats[i].silent()[0], (link::RobotRange{0, 3}));
    EXPECT_EQ(beats[i].silent()[1], (link::RobotRange{4, 1}));
    EXPECT_EQ(UtcTime(Duration(beats[i].sent_ns)), time(500 * static_cast<int>(i)).utc);
    EXPECT_EQ(beats[i].late().size(), i == 2 ? 1U : 0U) << "late from 1.25 s on";
  }
  EXPECT_EQ(beats[2].late()[0],
            (link::LateRobot{.robot = 3, .age_ms = 1600, .x_m = 4.0, .y_m = 2.0}));
}

TEST(BeatSender, StatesNothingAboutTheOthersWhileRobotsMayNotReceiveEachOther) {
  if (!link::carries_multicast()) GTEST_SKIP() << "loopback carries no multicast here";
  const auto robots = *link::StopReceiver::open({.domain = 219});
  const Supervisor supervisor({.robots = 5, .launcher = {}, .script = {}}, at(0));
  BeatSender sut(*link::StopSender::open({.domain = 219}), 77);

  LateRobots late(5, 1.0);
  sut.step(time(0), supervisor, late, false);
  sut.step(time(500), supervisor, late, true);

  std::vector<link::LauncherBeat> beats;
  for (int i = 0; i < 5000 && beats.size() < 2; ++i) {
    robots->take();
    beats.insert(beats.end(), robots->beats().begin(), robots->beats().end());
    std::this_thread::sleep_for(milliseconds(1));
  }
  ASSERT_EQ(beats.size(), 2U);
  EXPECT_FALSE(beats[0].lists_all);
  EXPECT_TRUE(beats[1].lists_all);
}

}  // namespace
}  // namespace swarm::launcher
