// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Every channel over every backend: joining, leaving and receiving cells.
#include "swarm_link/channels/state_channel.hpp"

#include <set>

#include <gtest/gtest.h>

#include "tests/conformance/bus.hpp"

namespace swarm::link::conformance {
namespace {

class StateChannels : public testing::TestWithParam<Backend> {
 protected:
  struct Robot {
    std::unique_ptr<StateChannel> channel;
    RobotStateMessage state;
    std::set<std::uint32_t> received{};

    void tick() {
      const Vec2 position_m(state.x_m, state.y_m);
      channel->listen_around({&position_m, 1});
      channel->publish({&state, 1});
      std::vector<CellStatesMessage> batches;
      channel->take(batches);
      for (const auto& batch : batches) {
        for (const auto& other : batch.states) received.insert(other.robot_id);
      }
    }
  };

  Robot robot(std::uint32_t id, double x_m, double y_m) {
    return {.channel = bus->channel({}), .state = {.robot_id = id, .x_m = x_m, .y_m = y_m}};
  }

  std::unique_ptr<Bus> bus = GetParam().make();
};

INSTANTIATE_TEST_SUITE_P(Backends, StateChannels, testing::ValuesIn(channel_backends()), name_of);

using TopicChannels = StateChannels;
INSTANTIATE_TEST_SUITE_P(Backends, TopicChannels, testing::ValuesIn(backends()), name_of);

TEST_P(StateChannels, ReceiveNeighboursAcrossACellBorder) {
  Robot left = robot(1, 18.0, 10.0);
  Robot right = robot(2, 22.0, 10.0);
  EXPECT_TRUE(bus->eventually([&] {
    left.tick();
    right.tick();
    return left.received.contains(2) && right.received.contains(1);
  }));
  EXPECT_EQ(left.channel->undecodable(), 0U);
}

TEST_P(StateChannels, ReceiveTheirOwnProcess) {
  Robot alone = robot(1, 5.0, 5.0);
  EXPECT_TRUE(bus->eventually([&] { return alone.tick(), alone.received.contains(1); }));
}

TEST_P(StateChannels, LoseAndFindEachOtherAsTheyMove) {
  Robot stays = robot(1, 10.0, 10.0);
  Robot roams = robot(2, 10.0, 10.0);
  const auto both_tick = [&] {
    stays.tick();
    roams.tick();
  };
  ASSERT_TRUE(bus->eventually([&] { return both_tick(), stays.received.contains(2); }));

  roams.state.x_m = 110.0;
  for (int i = 0; i < 6; ++i) both_tick();  // its next states also go to the cell that it left
  bus->converge();                          // what was under way
  both_tick();
  stays.received.clear();
  roams.received.clear();
  ASSERT_TRUE(bus->eventually([&] { return both_tick(), roams.received.contains(2); }));
  EXPECT_FALSE(stays.received.contains(2));
  EXPECT_FALSE(roams.received.contains(1));

  roams.state.x_m = 12.0;
  EXPECT_TRUE(bus->eventually(
      [&] { return both_tick(), stays.received.contains(2) && roams.received.contains(1); }));
}

TEST_P(TopicChannels, ReceiveARobotFromItsFirstStateInANewCell) {
  Robot left = robot(1, 18.0, 10.0);
  Robot right = robot(2, 24.0, 10.0);
  // Wait at the border until both cells' endpoints have found each other …
  left.state.x_m = 19.5;
  Participant& probe = bus->participant();
  const auto readers_of_right_cell = probe.make_writer(cell_topic({1, 0})).value();
  const auto writers_in_right_cell = probe.make_reader(cell_topic({1, 0})).value();
  ASSERT_TRUE(bus->eventually([&] {
    left.tick();
    right.tick();
    return right.received.contains(1) && readers_of_right_cell->matched() == 3 &&
           writers_in_right_cell->matched() == 3;
  }));
  bus->converge();
  std::vector<CellStatesMessage> before;
  writers_in_right_cell->take(before);

  left.state.x_m = 20.5;  // … and cross it.
  left.state.sequence_number = 1;
  left.tick();

  std::vector<CellStatesMessage> received;
  ASSERT_TRUE(bus->eventually([&] { return writers_in_right_cell->take(received) > 0; }));
  ASSERT_EQ(received[0].states.size(), 1U);
  EXPECT_EQ(received[0].states[0].robot_id, 1U);
  EXPECT_EQ(received[0].states[0].sequence_number, 1U);
}

// As while the discovery server does not run: no endpoint of the other's cell is known here.
TEST_P(TopicChannels, ReachRobotsOfOtherCellsWhilePublishingEverywhere) {
  Robot here = robot(1, 10.0, 10.0);
  Robot there = robot(2, 510.0, 510.0);
  here.channel->publish_everywhere(true);
  EXPECT_TRUE(bus->eventually([&] {
    here.tick();
    there.tick();
    return there.received.contains(1);
  }));
  EXPECT_FALSE(here.received.contains(2));

  here.channel->publish_everywhere(false);
  here.state.robot_id = 3;
  for (int i = 0; i < 20; ++i) {
    here.tick();
    bus->converge();
    there.tick();
  }
  EXPECT_FALSE(there.received.contains(3));
}

}  // namespace
}  // namespace swarm::link::conformance
