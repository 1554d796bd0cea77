// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Behaviour specific to the Fast DDS adapter: ports, buffers, discovery servers, late receivers.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/conformance/bus.hpp"

namespace swarm::link::conformance {
namespace {

/// UDP ports of the loopback interface that are in use by another process.
class OccupiedPorts {
 public:
  OccupiedPorts(std::uint16_t first, int count) {
    for (int i = 0; i < count; ++i) {
      const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      address.sin_port = htons(static_cast<std::uint16_t>(first + i));
      // A port that an unrelated process uses is occupied as well.
      (void)::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address);
      fds_.push_back(fd);
    }
  }
  ~OccupiedPorts() {
    for (const int fd : fds_) ::close(fd);
  }
  OccupiedPorts(const OccupiedPorts&) = delete;
  OccupiedPorts& operator=(const OccupiedPorts&) = delete;

 private:
  std::vector<int> fds_;
};

std::uint16_t first_port() { return static_cast<std::uint16_t>(7410 + 250 * test_domain()); }

struct FastDds : testing::Test {
  FastDdsOptions options(std::uint32_t index) const {
    return {
        .name = "test", .domain = test_domain(), .index = index, .discovery = server->address()};
  }
  std::unique_ptr<DiscoveryServer> server = make_discovery_server(test_domain(), 0).value();
};

// By default the vendor tries 100 ports and then continues without receiving anything.
TEST_F(FastDds, ReceivesAfterAHundredAndTenParticipantsUsedThePorts) {
  const OccupiedPorts others(first_port(), 2 * 110);
  const auto bus = join_fastdds_bus(server->address(), 0);
  auto& a = bus->participant();
  auto& b = bus->participant();
  const auto checked = a.self_check();
  EXPECT_TRUE(checked) << checked.error().message;

  const auto writer = a.make_writer(command_topic()).value();
  const auto reader = b.make_reader(command_topic()).value();
  writer->write({.command_id = 1});

  std::vector<CommandMessage> received;
  EXPECT_TRUE(bus->eventually([&] { return reader->take(received) > 0; }));
}

TEST_F(FastDds, ReportsThatItCannotReceiveWhenNoPortIsFree) {
  const OccupiedPorts others(first_port(), 2 * 110);
  for (const bool at_tick : {true, false}) {
    auto few_tries = options(0);
    few_tries.port_tries = 50;
    few_tries.receive_at_tick = at_tick;

    const auto participant = make_fastdds_participant(few_tries).value();

    const auto checked = participant->self_check();
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().code, ErrorCode::kEnvironment);
    EXPECT_NE(checked.error().message.find("cannot receive"), std::string::npos)
        << checked.error().message;
  }
}

TEST_F(FastDds, ReportsWhichKernelLimitKeepsItsBuffersSmall) {
  auto greedy = options(0);
  greedy.receive_buffer_bytes = 1 << 30;

  const auto participant = make_fastdds_participant(greedy).value();

  const auto checked = participant->self_check();
  ASSERT_FALSE(checked);
  EXPECT_NE(checked.error().message.find("net.core.rmem_max"), std::string::npos)
      << checked.error().message;
}

TEST_F(FastDds, RefusesOptionsThatCannotWork) {
  auto no_server = options(0);
  no_server.discovery.port = 0;
  EXPECT_FALSE(make_fastdds_participant(no_server));
  auto far_away = options(0);
  far_away.discovery.host = "192.0.2.1";
  EXPECT_FALSE(make_fastdds_participant(far_away));
  auto high_domain = options(0);
  high_domain.domain = 240;
  EXPECT_FALSE(make_fastdds_participant(high_domain));
  EXPECT_FALSE(make_discovery_server(240, 0));
}

TEST_F(FastDds, RefusesATakenServerPort) {
  const auto second = make_discovery_server(test_domain(), server->address().port);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kEnvironment);
}

TEST_F(FastDds, KeepsRunsOnDifferentServersApart) {
  const auto other_server = make_discovery_server(test_domain(), 0).value();
  const auto bus = join_fastdds_bus(server->address(), 0);
  const auto other_bus = join_fastdds_bus(other_server->address(), 10);
  const auto writer = bus->participant().make_writer(command_topic()).value();
  const auto reader = bus->participant().make_reader(command_topic()).value();
  const auto other_writer = other_bus->participant().make_writer(command_topic()).value();
  const auto other_reader = other_bus->participant().make_reader(command_topic()).value();
  writer->write({.command_id = 1});
  other_writer->write({.command_id = 2});

  std::vector<CommandMessage> received;
  std::vector<CommandMessage> other_received;
  ASSERT_TRUE(bus->eventually([&] { return reader->take(received) > 0; }));
  ASSERT_TRUE(other_bus->eventually([&] { return other_reader->take(other_received) > 0; }));
  bus->converge();
  other_bus->converge();
  reader->take(received);
  other_reader->take(other_received);

  EXPECT_EQ(received, std::vector{CommandMessage{.command_id = 1}});
  EXPECT_EQ(other_received, std::vector{CommandMessage{.command_id = 2}});
  EXPECT_EQ(writer->matched(), 1);
  EXPECT_EQ(other_writer->matched(), 1);
}

TEST_F(FastDds, FindsNewcomersAgainAfterItsServerRestarted) {
  const auto bus = join_fastdds_bus(server->address(), 0);
  const auto writer = bus->participant().make_writer(command_topic()).value();
  const auto reader = bus->participant().make_reader(command_topic()).value();
  ASSERT_TRUE(bus->eventually([&] { return reader->matched() == 1; }));
  const auto port = server->address().port;
  server.reset();
  writer->write({.command_id = 1});  // peers that know each other need no server
  std::vector<CommandMessage> received;
  EXPECT_TRUE(bus->eventually([&] { return reader->take(received) > 0; }));

  server = make_discovery_server(test_domain(), port).value();

  const auto late = bus->participant().make_reader(command_topic()).value();
  EXPECT_TRUE(bus->eventually([&] { return late->take(received) > 0; }));
}

TEST_F(FastDds, ReceivesNothingBeforeReceiveIsCalled) {
  const auto bus = join_fastdds_bus(server->address(), 0);
  const auto writer = bus->participant().make_writer(cell_topic({0, 0})).value();
  const auto reader = bus->participant().make_reader(cell_topic({0, 0})).value();
  ASSERT_TRUE(bus->eventually([&] { return writer->matched() == 1 && reader->matched() == 1; }));

  writer->write({.cell_x = 1});

  std::vector<CellStatesMessage> received;
  EXPECT_EQ(reader->take(received), 0U);
  EXPECT_TRUE(bus->eventually([&] { return reader->take(received) > 0; }));
}

// A reader that never ticks must not block a reliable writer, nor make its memory grow.
TEST_F(FastDds, WritesOnWhileAReaderSleeps) {
  const auto bus = join_fastdds_bus(server->address(), 0);
  const auto writer = bus->participant().make_writer(event_topic()).value();
  const auto awake = bus->participant().make_reader(event_topic()).value();
  const auto sleeper = make_fastdds_participant(options(20)).value();
  const auto asleep = sleeper->make_reader(event_topic()).value();
  ASSERT_TRUE(bus->eventually([&] { return writer->matched() == 2; }));

  std::vector<EventMessage> received;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    EXPECT_TRUE(writer->write({.source = i}));
    bus->pump();
    awake->take(received);
  }

  EXPECT_TRUE(bus->eventually([&] {
    awake->take(received);
    return !received.empty() && received.back().source == 999;
  }));
  EXPECT_TRUE(bus->eventually([&] {
    sleeper->receive();
    received.clear();
    asleep->take(received);
    return !received.empty() && received.back().source == 999;
  }));
}

}  // namespace
}  // namespace swarm::link::conformance
