// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/stop_order.hpp"

#include <array>
#include <chrono>
#include <optional>
#include <thread>
#include <vector>

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

  /// One step at a time after the beginning.
  void step(milliseconds at) {
    order->step(begin + at, UtcTime(std::chrono::seconds(1'800'000'000)));
  }

  /// Whether the stop that was sent reaches a process; the kernel may take its time.
  bool reaches(std::size_t process) {
    return soon([&] { return processes.at(process)->take().has_value(); });
  }
  /// A process confirms the stop that it has received.
  void confirm(std::size_t process, const link::StopConfirmation& stopped) {
    ASSERT_TRUE(reaches(process));
    processes.at(process)->confirm(stopped);
  }
  /// Steps at one time until this number of robots have confirmed.
  bool step_until_confirmed(milliseconds at, std::uint32_t robots) {
    return soon([&] {
      step(at);
      return order->confirmed() == robots;
    });
  }

  SteadyTime begin{std::chrono::hours(1)};
  std::array<std::unique_ptr<link::StopReceiver>, 2> processes;
  std::optional<StopOrder> order;

 private:
  template <class Condition>
  static bool soon(Condition holds) {
    for (int i = 0; i < 5000; ++i) {
      if (holds()) return true;
      std::this_thread::sleep_for(milliseconds(1));
    }
    return false;
  }
};

TEST_F(StopOrderTest, IsCompleteOnceAllRobotsHaveConfirmed) {
  begin_in(216);
  step(milliseconds(0));
  confirm(0, {.first_robot_id = 0, .robots = 2});
  ASSERT_TRUE(step_until_confirmed(milliseconds(20), 2));
  EXPECT_EQ(order->newly_confirmed(), (std::vector<RobotId>{RobotId(0), RobotId(1)}));
  EXPECT_FALSE(order->is_complete());
  EXPECT_EQ(order->unconfirmed(), (std::vector<RobotId>{RobotId(2), RobotId(3)}));
  confirm(1, {.first_robot_id = 2, .robots = 2});
  EXPECT_TRUE(step_until_confirmed(milliseconds(40), 4));
  EXPECT_TRUE(order->is_complete());
  EXPECT_TRUE(order->unconfirmed().empty());
}

TEST_F(StopOrderTest, SendsAtEachStepOfTheFirstHalfSecondAndThenEvery50ms) {
  begin_in(217);
  for (int ms = 0; ms < 500; ms += 20) {
    step(milliseconds(ms));
    ASSERT_TRUE(reaches(0)) << ms;
  }
  for (int ms = 500; ms < 1500; ms += 10) {
    step(milliseconds(ms));
    const bool is_due = ms % 50 == 0;
    ASSERT_EQ(is_due ? reaches(0) : processes[0]->take().has_value(), is_due) << ms;
  }
}

// Datagrams of one process keep their order: once the last one has come, all have.
TEST_F(StopOrderTest, IgnoresConfirmationsOfRobotsThatTheRunDoesNotHave) {
  begin_in(218);
  step(milliseconds(0));
  confirm(0, {.first_robot_id = 3, .robots = 0xFFFFFFFFU});
  step(milliseconds(20));
  confirm(0, {.first_robot_id = 4, .robots = 1});
  step(milliseconds(40));
  confirm(0, {.first_robot_id = 1, .robots = 1});
  ASSERT_TRUE(step_until_confirmed(milliseconds(60), 1));
  EXPECT_EQ(order->unconfirmed(), (std::vector<RobotId>{RobotId(0), RobotId(2), RobotId(3)}));
}

}  // namespace
}  // namespace swarm::launcher
