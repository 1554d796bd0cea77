// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/udp_socket.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "swarm_core/base/clock.hpp"
#include "swarm_link/channels/groups/group_channel.hpp"

namespace swarm::link {
namespace {

constexpr const char* kNoInterface = "192.0.2.1";  // TEST-NET-1: of no machine [RFC 5737]

std::string text_of(const in_addr& address) {
  char text[INET_ADDRSTRLEN] = "";
  ::inet_ntop(AF_INET, &address, text, sizeof text);
  return text;
}

TEST(Address, IsParsedOrThatOfLoopback) {
  for (const char* address : {"127.0.0.1", "10.1.2.3", "0.0.0.0", "255.255.255.255"}) {
    EXPECT_EQ(text_of(to_in_addr(address)), address);
  }
  for (const char* rubbish :
       {"", "localhost", "1.2.3", "1.2.3.4.5", "256.0.0.1", "1.2.3.4 ", "::1"}) {
    EXPECT_EQ(text_of(to_in_addr(rubbish)), kLoopback) << rubbish;
  }
}

TEST(Address, IsMulticastFrom224To239) {
  EXPECT_FALSE(is_multicast(to_in_addr("223.255.255.255")));
  EXPECT_TRUE(is_multicast(to_in_addr("224.0.0.0")));
  EXPECT_TRUE(is_multicast(to_in_addr("239.255.255.255")));
  EXPECT_FALSE(is_multicast(to_in_addr("240.0.0.0")));
}

TEST(MulticastGroup, HasTheLow16BitsOfTheHashAndThePortOfTheDomain) {
  for (const std::uint32_t hash : {0U, 1U, 255U, 256U, 0xFFFFU, 0x10000U, 0xFFFFFFFFU}) {
    const sockaddr_in group = multicast_group(3, hash);
    EXPECT_EQ(text_of(group.sin_addr), "239.255." + std::to_string((hash >> 8U) & 0xFFU) + "." +
                                           std::to_string(hash & 0xFFU));
    EXPECT_EQ(ntohs(group.sin_port), 7400 + 250 * 3 + 1);  // DDSI-RTPS 9.6.1.1
    EXPECT_TRUE(is_multicast(group.sin_addr));
  }
}

sockaddr_in at_loopback(std::uint16_t port = 0) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  return address;
}

sockaddr_in address_of(int fd) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  EXPECT_EQ(::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size), 0);
  return address;
}

TEST(ReceiveSocket, SharesItsPortOnlyIfAllOfItsSocketsAgree) {
  const int alone = open_receive_socket(at_loopback(), 1 << 16);
  ASSERT_GE(alone, 0);
  EXPECT_EQ(open_receive_socket(address_of(alone), 1 << 16), -1);
  EXPECT_EQ(open_receive_socket(address_of(alone), 1 << 16, true), -1);
  const int shared = open_receive_socket(at_loopback(), 1 << 16, true);
  ASSERT_GE(shared, 0);
  const int other = open_receive_socket(address_of(shared), 1 << 16, true);
  EXPECT_GE(other, 0);
  for (const int fd : {alone, shared, other}) ::close(fd);
}

TEST(ReceiveBuffer, IsGrantedAsAskedUpToTheKernelsLimit) {
  EXPECT_EQ(granted_receive_buffer_bytes(1 << 16), 1 << 16);  // far below any limit in use
  EXPECT_GE(granted_receive_buffer_bytes(1 << 30), 1 << 16);
}

TEST(GroupSender, NeedsAnInterfaceOfThisMachine) {
  EXPECT_EQ(open_group_sender(to_in_addr(kNoInterface)), -1);
  EXPECT_FALSE(carries_multicast(kNoInterface));
  const auto channel = make_group_channel({.interface = kNoInterface});
  ASSERT_FALSE(channel);
  EXPECT_EQ(channel.error().code, ErrorCode::kEnvironment);
  EXPECT_EQ(channel.error().message,
            "the interface with address 192.0.2.1 carries no multicast: set it up ('ip link set lo "
            "up' for 127.0.0.1), let firewalls pass 239.255.0.0/16, or use --channel topics");
}

struct Received final : DatagramSink {
  void datagram(std::span<std::byte> bytes, const sockaddr_in& sender) override {
    datagrams.emplace_back(bytes.begin(), bytes.end());
    ports.push_back(sender.sin_port);
    for (std::byte& byte : bytes) byte = std::byte{0};  // which a sink may do
  }
  std::vector<std::vector<std::byte>> datagrams;
  std::vector<in_port_t> ports;
};

struct DrainTest : testing::Test {
  ~DrainTest() override {
    ::close(receiver);
    ::close(sender);
  }
  void send(const std::vector<std::byte>& bytes) {
    const sockaddr_in to = address_of(receiver);
    ASSERT_EQ(::sendto(sender, bytes.data(), bytes.size(), 0,
                       reinterpret_cast<const sockaddr*>(&to), sizeof to),
              static_cast<ssize_t>(bytes.size()));
  }
  /// Loopback delivers within sendto(), so no test has to wait.
  Received drained(DatagramDrain& drain) const {
    Received received;
    drain.drain(receiver, received);
    return received;
  }

  int receiver = open_receive_socket(at_loopback(), 1 << 18);
  int sender = open_receive_socket(at_loopback(), 1 << 16);
};

TEST_F(DrainTest, PassesEveryDatagramOnceInOrderWithItsSender) {
  DatagramDrain sut;
  std::vector<std::vector<std::byte>> sent;
  for (std::size_t i = 0; i < 100; ++i) {  // several system calls' worth
    sent.emplace_back(i, static_cast<std::byte>(i));
    send(sent.back());
  }

  const Received received = drained(sut);

  EXPECT_EQ(received.datagrams, sent);
  for (const in_port_t port : received.ports) EXPECT_EQ(port, address_of(sender).sin_port);
  EXPECT_TRUE(drained(sut).datagrams.empty());
}

TEST_F(DrainTest, PassesTheLargestDatagramWhole) {
  DatagramDrain sut;
  const std::vector<std::byte> largest(65'507, std::byte{7});  // of UDP over IPv4
  send(largest);
  const Received received = drained(sut);
  ASSERT_EQ(received.datagrams.size(), 1U);
  EXPECT_EQ(received.datagrams[0], largest);
}

TEST_F(DrainTest, ReadsTheSocketsThatHoldDatagrams) {
  DatagramDrain sut;
  SocketSet sockets;
  sockets.add(sender);
  sockets.add(receiver);
  EXPECT_TRUE(sut.to_read(sockets).empty());
  send({std::byte{1}});
  EXPECT_TRUE(std::ranges::equal(sut.to_read(sockets), std::array{receiver}));
  EXPECT_EQ(drained(sut).datagrams.size(), 1U);
  EXPECT_TRUE(sut.to_read(sockets).empty());
}

TEST_F(DrainTest, HandsOutWhatIsDueOfASocketThatHoldsNothingMore) {
  constexpr auto kDelay = std::chrono::milliseconds(20);
  DatagramDrain sut({.faults = {.delay = kDelay}, .run_began = utc_now()});
  SocketSet sockets;
  sockets.add(receiver);
  send({std::byte{1}});
  EXPECT_TRUE(drained(sut).datagrams.empty()) << "takes it from the socket";

  std::this_thread::sleep_for(2 * kDelay);

  ASSERT_TRUE(std::ranges::equal(sut.to_read(sockets), std::array{receiver}));
  EXPECT_EQ(drained(sut).datagrams, (std::vector<std::vector<std::byte>>{{std::byte{1}}}));
}

TEST_F(DrainTest, LosesAndDelaysByItsFaults) {
  const UtcTime now = utc_now();
  DatagramDrain loses({.faults = {.loss = 1.0}, .run_began = now});
  DatagramDrain delays({.faults = {.delay = std::chrono::hours(1)}, .run_began = now});
  DatagramDrain later({.faults = {.loss = 1.0, .from = std::chrono::hours(1)}, .run_began = now});
  for (DatagramDrain* sut : {&loses, &delays}) {
    send({std::byte{1}});
    EXPECT_TRUE(drained(*sut).datagrams.empty());
  }
  send({std::byte{2}});
  EXPECT_EQ(drained(later).datagrams, (std::vector<std::vector<std::byte>>{{std::byte{2}}}))
      << "outside the time of the faults";
}

}  // namespace
}  // namespace swarm::link
