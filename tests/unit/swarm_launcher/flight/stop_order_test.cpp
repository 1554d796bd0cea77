// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/stop_order.hpp"

#include <array>
#include <optional>

#include <gtest/gtest.h>

#include "swarm_link/udp_socket.hpp"

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;

/// An order to four robots in two processes, and the end of each process. Each test has a domain of
/// its own, as tests run at the same time.
class StopOrderTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!link::carries_multicast()) GTEST_SKIP() << "loopback carries no multicast here";
  }

  void begin_in(std::uint32_t domain) {
    for (auto& process : processes) process = *link::StopReceiver::open({.domain = domain});
    order.emplace(*link::StopSender::open({.domain = domain}), 4);
  }

  /// One step at a time after the beginning; the processes in `alive` confirm what reaches them.
  void step(milliseconds at, std::initializer_list<std::size_t> alive = {}) {
    order->step(begin + at, UtcTime(std::chrono::seconds(1'800'000'000)));
    for (const std::size_t i : alive) {
      sent += processes.at(i)->take().has_value() ? 1 : 0;
      processes.at(i)->confirm({.first_robot_id = static_cast<std::uint32_t>(2 * i), .robots = 2});
    }
  }

  SteadyTime begin{std::chrono::hours(1)};
  std::array<std::unique_ptr<link::StopReceiver>, 2> processes;
  std::optional<StopOrder> order;
  int sent = 0;
};

TEST_F(StopOrderTest, IsCompleteOnceAllRobotsHaveConfirmed) {
  begin_in(216);
  step(milliseconds(0), {0});
  step(milliseconds(20), {0});
  EXPECT_EQ(order->newly_confirmed(), (std::vector<RobotId>{RobotId(0), RobotId(1)}));
  EXPECT_EQ(order->confirmed(), 2U);
  EXPECT_FALSE(order->is_complete());
  EXPECT_EQ(order->unconfirmed(), (std::vector<RobotId>{RobotId(2), RobotId(3)}));
  step(milliseconds(40), {1});
  step(milliseconds(60));
  EXPECT_TRUE(order->is_complete());
  EXPECT_TRUE(order->unconfirmed().empty());
}

TEST_F(StopOrderTest, SendsAtEachStepOfTheFirstHalfSecondAndThenEvery50ms) {
  begin_in(217);
  for (int ms = 0; ms < 500; ms += 20) step(milliseconds(ms), {0});
  EXPECT_EQ(sent, 25);
  for (int ms = 500; ms < 1500; ms += 10) step(milliseconds(ms), {0});
  EXPECT_EQ(sent, 25 + 20);
}

TEST_F(StopOrderTest, IgnoresConfirmationsOfRobotsThatTheRunDoesNotHave) {
  begin_in(218);
  step(milliseconds(0));
  ASSERT_TRUE(processes[0]->take());
  processes[0]->confirm({.first_robot_id = 3, .robots = 0xFFFFFFFFU});
  step(milliseconds(20));
  ASSERT_TRUE(processes[0]->take());
  processes[0]->confirm({.first_robot_id = 4, .robots = 1});
  step(milliseconds(40));
  EXPECT_EQ(order->confirmed(), 0U);
}

}  // namespace
}  // namespace swarm::launcher
