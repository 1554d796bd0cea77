// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The stop channel over real multicast on loopback, each test in a domain that nothing else uses:
// tests run at the same time.
#include "swarm_link/channels/stop_channel.hpp"

#include <chrono>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "swarm_core/base/clock.hpp"
#include "swarm_link/cdr/codec.hpp"
#include "swarm_link/udp_socket.hpp"

namespace swarm::link {
namespace {

constexpr CommandMessage kStopMessage{.kind = CommandKind::kStop, .command_id = 7};

std::unique_ptr<StopSender> sender(std::uint32_t domain) {
  auto made = StopSender::open({.domain = domain});
  return made ? std::move(*made) : nullptr;
}

std::unique_ptr<StopReceiver> receiver(std::uint32_t domain, const ReceptionFaults& faults = {}) {
  auto made = StopReceiver::open({.domain = domain, .faults = faults});
  return made ? std::move(*made) : nullptr;
}

/// The stop that has been sent; the kernel may take its time on a busy machine.
std::optional<CommandMessage> take_sent(StopReceiver& receiver) {
  for (int i = 0; i < 5000; ++i) {
    if (const auto stop = receiver.take()) return stop;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return std::nullopt;
}

class StopChannel : public testing::Test {
 protected:
  void SetUp() override {
    if (!carries_multicast()) GTEST_SKIP() << "loopback carries no multicast here";
  }
};

TEST_F(StopChannel, ReachesEveryReceiverOfTheDomain) {
  const auto from = sender(210);
  const auto first = receiver(210), second = receiver(210), other = receiver(211);
  from->send(kStopMessage);
  EXPECT_EQ(take_sent(*first), kStopMessage);
  EXPECT_EQ(take_sent(*second), kStopMessage);
  EXPECT_FALSE(other->take());
  EXPECT_FALSE(first->take()) << "each stop once";
}

/// Sends a message as a stop, whatever it is.
void send_as_stop(std::uint32_t domain, const CommandMessage& message) {
  std::vector<std::byte> bytes;
  for (const char c : {'S', 'W', 'S', 'T', 'O', 'P', '\0', '\1'}) {
    bytes.push_back(static_cast<std::byte>(c));
  }
  std::vector<std::byte> sample;
  encode(message, sample);
  bytes.insert(bytes.end(), sample.begin(), sample.end());
  sockaddr_in group = multicast_group(domain, 0);
  group.sin_addr.s_addr = htonl(0xEFFEFFFFU);
  const int fd = open_group_sender(to_in_addr(kLoopback));
  ::sendto(fd, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&group),
           sizeof group);
  ::close(fd);
}

// Such a message would start robots, or take the place of a stop that arrives with it.
TEST_F(StopChannel, TakesNothingButStops) {
  const auto from = sender(224);
  const auto robots = receiver(224);
  from->send(kStopMessage);
  CommandMessage resume = kStopMessage;
  resume.kind = CommandKind::kResume;
  send_as_stop(224, resume);
  CommandMessage other = kStopMessage;
  other.schema_version = 99;
  send_as_stop(224, other);

  bool is_stopped = false;
  for (int i = 0; i < 5000 && !(is_stopped && robots->undecodable() == 2); ++i) {
    const auto stop = robots->take();
    if (stop) {
      EXPECT_EQ(*stop, kStopMessage);
    }
    is_stopped = is_stopped || stop;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_TRUE(is_stopped);
  EXPECT_EQ(robots->undecodable(), 2U);
}

TEST_F(StopChannel, BringsConfirmationsToThoseWhoSent) {
  const auto asked = sender(212), silent = sender(212);
  const auto robots = receiver(212);
  asked->send(kStopMessage);
  ASSERT_TRUE(take_sent(*robots));
  robots->confirm({.first = 40, .count = 3});
  robots->confirm({.first = 40, .count = 3});  // no stop since the last one
  std::vector<StopConfirmation> to_asked, to_silent;
  for (int i = 0; i < 5000 && to_asked.empty(); ++i) {
    asked->take(to_asked);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  silent->take(to_silent);
  ASSERT_EQ(to_asked.size(), 1U);
  EXPECT_EQ(to_asked[0].first_robot_id, 40U);
  EXPECT_EQ(to_asked[0].robots, 3U);
  EXPECT_EQ(to_asked[0].command_id, kStopMessage.command_id);
  EXPECT_TRUE(to_silent.empty());
}

TEST_F(StopChannel, ConfirmsToEachSenderItsOwnStop) {
  const auto first = sender(220), second = sender(220);
  const auto robots = receiver(220);
  CommandMessage stop = kStopMessage;
  first->send(stop);
  ASSERT_TRUE(take_sent(*robots));
  stop.command_id = 8;
  first->send(stop);  // the last one of a sender counts
  ASSERT_TRUE(take_sent(*robots));
  stop.command_id = 9;
  second->send(stop);
  ASSERT_TRUE(take_sent(*robots));
  robots->confirm({.first = 40, .count = 3});
  for (const auto& [from, id] : {std::pair(first.get(), 8U), std::pair(second.get(), 9U)}) {
    std::vector<StopConfirmation> confirmed;
    for (int i = 0; i < 5000 && confirmed.empty(); ++i) {
      from->take(confirmed);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ASSERT_EQ(confirmed.size(), 1U);
    EXPECT_EQ(confirmed[0].command_id, id);
  }
}

TEST_F(StopChannel, CarriesTheLaunchersBeatsBesideStops) {
  const auto from = sender(217);
  const auto robots = receiver(217);
  LauncherBeat beat{.run = 5};
  const std::vector<RobotId> silent = {RobotId(3), RobotId(4)};
  set_silent(beat, silent);
  for (int i = 0; i < 20; ++i) {
    ++beat.sequence;
    from->send(beat);
  }
  from->send(kStopMessage);
  // The stop is the last datagram, but the kernel may deliver it later than the others.
  std::uint64_t newest = 0;
  bool is_stopped = false;
  for (int i = 0; i < 5000 && !is_stopped; ++i) {
    is_stopped = robots->take().has_value();
    EXPECT_LE(robots->beats().size(), 8U);
    for (const LauncherBeat& b : robots->beats()) {
      EXPECT_GT(b.sequence, newest);
      newest = b.sequence;
      EXPECT_EQ(b.run, 5U);
      ASSERT_EQ(b.silent().size(), 1U);
      EXPECT_EQ(b.silent()[0], (RobotRange{3, 2}));
    }
    if (!is_stopped) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_TRUE(is_stopped);
  EXPECT_EQ(newest, 20U) << "the last one is kept";
  EXPECT_FALSE(robots->take());
  EXPECT_TRUE(robots->beats().empty()) << "each beat once";
}

TEST_F(StopChannel, IgnoresWhatIsNoStop) {
  const auto robots = receiver(213);
  const auto from = sender(213);
  const int fd = open_group_sender(to_in_addr(kLoopback));
  sockaddr_in group = multicast_group(213, 0);
  group.sin_addr.s_addr = htonl(0xEFFEFFFFU);
  for (const std::string& text :
       {std::string("?"), std::string("SWSTOP"), std::string("SWSTOP\0\1", 8),
        std::string("SWSTOP\0\1\0\1\0\0abc", 15), std::string("SWSTOP\2\1abc", 11),
        std::string(60'000, 'x')}) {
    ::sendto(fd, text.data(), text.size(), 0, reinterpret_cast<const sockaddr*>(&group),
             sizeof group);
  }
  ::close(fd);
  EXPECT_FALSE(robots->take());
  EXPECT_TRUE(robots->beats().empty());
  from->send(kStopMessage);
  EXPECT_TRUE(take_sent(*robots));
}

// Half of the datagrams are lost: one of twelve arrives with probability 1 − 2⁻¹².
TEST_F(StopChannel, GetsThroughALossyNetworkByRepetition) {
  const auto from = sender(214);
  int reached = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const auto robots = receiver(214, {.faults = {.loss = 0.5}, .seed = seed});
    for (int i = 0; i < 12; ++i) from->send(kStopMessage);
    reached += take_sent(*robots).has_value() ? 1 : 0;
  }
  EXPECT_EQ(reached, 50);
}

TEST_F(StopChannel, ReportsAnInterfaceThatCarriesNoMulticast) {
  const auto made = StopReceiver::open({.domain = 215, .interface = "203.0.113.7"});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kEnvironment);
  EXPECT_NE(made.error().message.find("203.0.113.7"), std::string::npos);
}

}  // namespace
}  // namespace swarm::link
