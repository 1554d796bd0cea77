// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/stop_order.hpp"

#include <array>
#include <chrono>
#include <cstring>
#include <optional>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

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
  void step(milliseconds at) { order->step(begin + at, UtcTime(Duration(kStopId))); }

  /// Whether the stop that was sent reaches a process; the kernel may take its time.
  bool reaches(std::size_t process) {
    return soon([&] { return processes.at(process)->take().has_value(); });
  }
  /// A process confirms the stop that it has received.
  void confirm(std::size_t process, const link::RobotRange& stopped) {
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

  static constexpr std::int64_t kStopId = 1'800'000'000'000'000'000;
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
  confirm(0, {.first = 0, .count = 2});
  ASSERT_TRUE(step_until_confirmed(milliseconds(20), 2));
  EXPECT_EQ(order->newly_confirmed(), (std::vector<RobotId>{RobotId(0), RobotId(1)}));
  EXPECT_FALSE(order->is_complete());
  EXPECT_EQ(order->unconfirmed(), (std::vector<RobotId>{RobotId(2), RobotId(3)}));
  confirm(1, {.first = 2, .count = 2});
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

/// Receives the stops of a domain, and answers as no robot does.
class StopForger {
 public:
  explicit StopForger(std::uint32_t domain) {
    sockaddr_in group = link::multicast_group(domain, 0);
    group.sin_addr.s_addr = htonl(0xEFFEFFFFU);
    fd_ = link::open_receive_socket(group, 1 << 16);
    link::join_group(fd_, group.sin_addr, link::to_in_addr(link::kLoopback));
  }
  ~StopForger() { ::close(fd_); }
  StopForger(const StopForger&) = delete;
  StopForger& operator=(const StopForger&) = delete;

  /// Whether a stop arrives; remembers who has sent it.
  bool receives() {
    std::array<std::byte, 1024> bytes;
    for (int i = 0; i < 5000; ++i) {
      socklen_t size = sizeof from_;
      const auto n = ::recvfrom(fd_, bytes.data(), bytes.size(), 0,
                                reinterpret_cast<sockaddr*>(&from_), &size);
      if (n > 0) return true;
      std::this_thread::sleep_for(milliseconds(1));
    }
    return false;
  }
  void answer(const link::StopConfirmation& forged) const {
    constexpr std::array<char, 8> kHeader{'S', 'W', 'S', 'T', 'O', 'P', 1, 2};
    std::array<std::byte, sizeof kHeader + sizeof forged> bytes{};
    std::memcpy(bytes.data(), kHeader.data(), sizeof kHeader);
    std::memcpy(bytes.data() + sizeof kHeader, &forged, sizeof forged);
    const int fd = link::open_group_sender(link::to_in_addr(link::kLoopback));
    ::sendto(fd, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&from_),
             sizeof from_);
    ::close(fd);
  }

 private:
  int fd_ = -1;
  sockaddr_in from_{};
};

// Datagrams on loopback keep their order: once the last one has come, all have.
TEST_F(StopOrderTest, IgnoresConfirmationsOfAnotherStop) {
  begin_in(219);
  StopForger forger(219);
  step(milliseconds(0));
  ASSERT_TRUE(forger.receives());
  forger.answer({.first_robot_id = 0, .robots = 4, .command_id = 0});
  forger.answer({.first_robot_id = 0, .robots = 4, .command_id = kStopId - 1});
  forger.answer({.first_robot_id = 2, .robots = 1, .command_id = kStopId});
  ASSERT_TRUE(step_until_confirmed(milliseconds(20), 1));
  EXPECT_EQ(order->newly_confirmed(), std::vector<RobotId>{RobotId(2)});
}

// Datagrams of one process keep their order: once the last one has come, all have.
TEST_F(StopOrderTest, IgnoresConfirmationsOfRobotsThatTheRunDoesNotHave) {
  begin_in(218);
  step(milliseconds(0));
  confirm(0, {.first = 3, .count = 0xFFFFFFFFU});
  step(milliseconds(20));
  confirm(0, {.first = 4, .count = 1});
  step(milliseconds(40));
  confirm(0, {.first = 1, .count = 1});
  ASSERT_TRUE(step_until_confirmed(milliseconds(60), 1));
  EXPECT_EQ(order->unconfirmed(), (std::vector<RobotId>{RobotId(0), RobotId(2), RobotId(3)}));
}

}  // namespace
}  // namespace swarm::launcher
