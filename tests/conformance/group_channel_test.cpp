// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Behaviour specific to multicast groups, where any process may send anything.
#include "swarm_link/channels/groups/group_channel.hpp"

#include <set>
#include <thread>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/conformance/bus.hpp"

namespace swarm::link::conformance {
namespace {

using Datagram = std::vector<unsigned char>;

/// A plain socket in the group of a cell, which receives and sends bytes.
class Stranger {
 public:
  explicit Stranger(Cell cell) : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const GroupAddress group = group_address(test_domain(), cell);
    address_.sin_family = AF_INET;
    address_.sin_port = htons(group.port);
    ::inet_pton(AF_INET, group.host.c_str(), &address_.sin_addr);
    const int yes = 1;
    ip_mreqn through_loopback{};
    through_loopback.imr_multiaddr = address_.sin_addr;
    through_loopback.imr_address.s_addr = htonl(INADDR_LOOPBACK);
    const timeval timeout{.tv_sec = 30, .tv_usec = 0};
    ::setsockopt(fd_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    ::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
    ::bind(fd_, reinterpret_cast<const sockaddr*>(&address_), sizeof address_);
    ::setsockopt(fd_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &through_loopback, sizeof through_loopback);
    ::setsockopt(fd_, IPPROTO_IP, IP_MULTICAST_IF, &through_loopback, sizeof through_loopback);
  }
  ~Stranger() { ::close(fd_); }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;

  Datagram receive() const {
    Datagram bytes(65'536);
    const ssize_t size = ::recv(fd_, bytes.data(), bytes.size(), 0);
    bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
    return bytes;
  }
  void send(const Datagram& bytes) const {
    ::sendto(fd_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&address_),
             sizeof address_);
  }

 private:
  int fd_;
  sockaddr_in address_{};
};

struct GroupChannelTest : testing::Test {
  static std::unique_ptr<StateChannel> make() {
    return make_group_channel({.domain = test_domain()}).value();
  }
  static std::vector<CellStatesMessage> take(StateChannel& channel) {
    std::vector<CellStatesMessage> batches;
    channel.take(batches);
    return batches;
  }

  const Vec2 place_m{2.0, 2.0};  // in cell (0, 0)
  std::unique_ptr<StateChannel> receives = make();
  std::unique_ptr<StateChannel> speaks = make();
};

TEST_F(GroupChannelTest, ReceivesAStateAtOnce) {
  receives->listen_around({&place_m, 1});
  const RobotStateMessage state{.robot_id = 7, .sequence_number = 1, .x_m = 2.0, .y_m = 2.0};

  EXPECT_EQ(speaks->publish({&state, 1}), 1U);

  const auto received =
      take(*receives);  // no discovery, no waiting: loopback delivers while it sends
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].states, std::vector{state});
}

TEST_F(GroupChannelTest, ReceivesNothingFromCellsItLeft) {
  receives->listen_around({&place_m, 1});
  const Vec2 elsewhere_m(100.0, 100.0);
  const RobotStateMessage state{.robot_id = 7, .x_m = 2.0, .y_m = 2.0};

  EXPECT_TRUE(receives->receives_at(place_m));
  receives->listen_around({&elsewhere_m, 1});
  speaks->publish({&state, 1});

  EXPECT_FALSE(receives->receives_at(place_m));
  EXPECT_TRUE(take(*receives).empty());
}

TEST_F(GroupChannelTest, ListensToMoreCellsThanASocketHasMemberships) {
  std::vector<Vec2> places_m;
  std::vector<RobotStateMessage> states;
  for (std::uint32_t i = 0; i < 60; ++i) {  // the kernel allows a socket 20
    places_m.emplace_back(2.0 + 20.0 * i, 2.0);
    states.push_back({.robot_id = i, .x_m = places_m.back().x(), .y_m = 2.0});
  }
  receives->listen_around(places_m);

  EXPECT_EQ(speaks->publish(states), 60U);

  std::set<std::uint32_t> received;
  for (const auto& batch : take(*receives)) {
    for (const auto& state : batch.states) received.insert(state.robot_id);
  }
  EXPECT_EQ(received.size(), 60U);
}

/// While it exists, this process can open no further file.
class NoMoreFiles {
 public:
  NoMoreFiles() {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit none{.rlim_cur = 3, .rlim_max = before_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &none);
  }
  ~NoMoreFiles() { ::setrlimit(RLIMIT_NOFILE, &before_); }
  NoMoreFiles(const NoMoreFiles&) = delete;
  NoMoreFiles& operator=(const NoMoreFiles&) = delete;

 private:
  rlimit before_{};
};

TEST_F(GroupChannelTest, ReportsCellsThatItCannotJoinAndJoinsThemLater) {
  receives->listen_around({&place_m, 1});
  EXPECT_TRUE(receives->receives_all());
  const Vec2 elsewhere_m(100.0, 100.0);
  {
    const NoMoreFiles limit;
    receives->listen_around({&place_m, 1});
    EXPECT_TRUE(receives->receives_all()) << "joined already";
    receives->listen_around({&elsewhere_m, 1});
    EXPECT_FALSE(receives->receives_all());
    receives->listen_around({&elsewhere_m, 1});
    EXPECT_FALSE(receives->receives_all());
  }
  receives->listen_around({&elsewhere_m, 1});
  EXPECT_TRUE(receives->receives_all());
}

TEST_F(GroupChannelTest, GivesCellsOfAMapGroupsOfTheirOwn) {
  std::set<std::string> groups;
  for (std::int32_t x = -90; x < 90; ++x) {
    for (std::int32_t y = -89; y < 89; ++y) groups.insert(group_address(0, {x, y}).host);
  }
  EXPECT_EQ(groups.size(), 180U * 178U);
}

TEST_F(GroupChannelTest, DoesNotReceiveFromOtherDomains) {
  const auto other = make_group_channel({.domain = test_domain() + 100}).value();
  other->listen_around({&place_m, 1});
  const RobotStateMessage state{.x_m = 2.0, .y_m = 2.0};

  speaks->publish({&state, 1});

  EXPECT_TRUE(take(*other).empty());
}

// Every truncation and every corrupted byte of a real datagram, and noise: nothing but valid
// samples may come through, and the channel goes on.
TEST_F(GroupChannelTest, SurvivesWhateverIsSentToTheGroup) {
  const Stranger stranger({0, 0});
  const RobotStateMessage state{.robot_id = 7, .sequence_number = 1, .x_m = 2.0, .y_m = 2.0};
  speaks->publish({&state, 1});
  const Datagram genuine = stranger.receive();
  ASSERT_GT(genuine.size(), 20U);
  receives->listen_around({&place_m, 1});

  for (std::size_t size = 0; size < genuine.size(); ++size) {
    stranger.send(Datagram(genuine.begin(), genuine.begin() + static_cast<std::ptrdiff_t>(size)));
  }
  for (std::size_t at = 0; at < genuine.size(); ++at) {
    for (const int value : {0x00, 0x01, 0x7F, 0x80, 0xFF}) {
      Datagram corrupt = genuine;
      corrupt[at] = static_cast<unsigned char>(value);
      stranger.send(corrupt);
    }
    for (const auto& batch : take(*receives)) EXPECT_LE(batch.states.size(), kMaxCellStates);
  }
  EXPECT_GT(receives->undecodable(), 0U);

  const RobotStateMessage after{.robot_id = 7, .sequence_number = 2, .x_m = 2.0, .y_m = 2.0};
  speaks->publish({&after, 1});
  const auto received = take(*receives);
  ASSERT_FALSE(received.empty());
  EXPECT_EQ(received.back().states, std::vector{after});
}

}  // namespace
}  // namespace swarm::link::conformance
