// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "swarm_link/channels/state_channel.hpp"
#include "swarmflow/core/random.hpp"
#include "tests/support/inproc/inproc_bus.hpp"

namespace swarm::link {
namespace {

constexpr CellOptions kOptions{.cell_size_m = 10.0,
                               .communication_radius_m = 4.0,
                               .join_margin_m = 1.5,
                               .leave_margin_m = 3.0};

double distance_to_cell_m(const Vec2& p, const Cell& cell) {
  const Vec2 low(cell.x * kOptions.cell_size_m, cell.y * kOptions.cell_size_m);
  const Vec2 high = low + Vec2::Constant(kOptions.cell_size_m);
  return (p.cwiseMax(low).cwiseMin(high) - p).norm();
}

// Endpoints on every cell of a 6 × 6 field, whose matches reveal what the channel has open.
struct TopicChannelTest : testing::Test {
  TopicChannelTest() {
    for (int x = 0; x < 6; ++x) {
      for (int y = 0; y < 6; ++y) {
        writers[{x, y}] = probe->make_writer(cell_topic({x, y})).value();
        readers[{x, y}] = probe->make_reader(cell_topic({x, y})).value();
      }
    }
  }
  bool listens_to(const Cell& cell) { return writers[cell]->matched() > 1; }  // 1: the own probe
  bool publishes_in(const Cell& cell) { return readers[cell]->matched() > 1; }

  InprocBus bus;
  std::unique_ptr<Participant> probe = bus.make_participant();
  std::unique_ptr<Participant> own = bus.make_participant();
  std::unique_ptr<StateChannel> channel = make_topic_channel(*own, kOptions);
  std::map<Cell, WriterPtr<CellStatesMessage>> writers;
  std::map<Cell, ReaderPtr<CellStatesMessage>> readers;
};

TEST_F(TopicChannelTest, ListensToAllCellsItNeedsAndToNoneItDoesNot) {
  Rng rng(1);
  Vec2 p(30.0, 30.0);
  int joined_between = 0;
  for (int step = 0; step < 2'000; ++step) {
    p += Vec2(uniform(rng, -1.0, 1.0), uniform(rng, -1.0, 1.0));
    p = p.cwiseMax(1.0).cwiseMin(59.0);
    channel->listen_around({&p, 1});

    for (const auto& [cell, writer] : writers) {
      const double d = distance_to_cell_m(p, cell);
      if (d <= kOptions.communication_radius_m + kOptions.join_margin_m) {
        EXPECT_TRUE(listens_to(cell));
      } else if (d > kOptions.communication_radius_m + kOptions.leave_margin_m) {
        EXPECT_FALSE(listens_to(cell));
      } else {
        joined_between += listens_to(cell) ? 1 : 0;  // hysteresis: either is right
      }
    }
  }
  EXPECT_GT(joined_between, 0);
}

TEST_F(TopicChannelTest, HasItsWritersBeforeTheRobotCrosses) {
  for (double x = 25.0; x < 35.0; x += 0.1) {
    const Vec2 p(x, 25.0);
    channel->listen_around({&p, 1});
    for (const auto& [cell, reader] : readers) {
      if (distance_to_cell_m(p, cell) <= kOptions.join_margin_m) {
        EXPECT_TRUE(publishes_in(cell));
      }
    }
  }
}

TEST_F(TopicChannelTest, StatesWhereItReceives) {
  const Vec2 here(25.0, 25.0), far(55.0, 55.0);
  EXPECT_FALSE(channel->receives_at(here));
  channel->listen_around({&here, 1});
  EXPECT_TRUE(channel->receives_at(here));
  EXPECT_FALSE(channel->receives_at(far));
  channel->listen_around({&far, 1});
  EXPECT_FALSE(channel->receives_at(here));
}

TEST_F(TopicChannelTest, KeepsFewWritersOfLeftCells) {
  for (double s = 0.0; s < 55.0; s += 0.5) {
    const Vec2 p(1.0 + s, 1.0 + s);
    const RobotStateMessage state{.x_m = p.x(), .y_m = p.y()};
    channel->listen_around({&p, 1});
    EXPECT_EQ(channel->publish({&state, 1}), 1U);

    int open = 0;
    for (const auto& [cell, reader] : readers) open += publishes_in(cell) ? 1 : 0;
    EXPECT_LE(open, 8);
    EXPECT_TRUE(publishes_in(cell_of(p, kOptions.cell_size_m)));
  }
}

TEST_F(TopicChannelTest, PublishesInMoreCellsAtOnceThanItKeeps) {
  std::vector<RobotStateMessage> states;
  std::vector<Vec2> positions_m;
  for (int i = 0; i < 36; ++i) {
    positions_m.emplace_back(5.0 + 10.0 * (i % 6), 5.0 + 10.0 * (i / 6));
    states.push_back({.robot_id = static_cast<std::uint32_t>(i),
                      .x_m = positions_m.back().x(),
                      .y_m = positions_m.back().y()});
  }
  for (int tick = 0; tick < 3; ++tick) {
    channel->listen_around(positions_m);
    EXPECT_EQ(channel->publish(states), 36U);
  }
  for (auto& [cell, reader] : readers) {
    std::vector<CellStatesMessage> received;
    EXPECT_EQ(reader->take(received), 3U);
  }
}

TEST_F(TopicChannelTest, SplitsBatchesOverTheBoundAndLosesNone) {
  std::vector<RobotStateMessage> states(700);
  for (std::uint32_t i = 0; i < states.size(); ++i) {
    states[i].robot_id = i;
    states[i].x_m = i % 7 == 0 ? 15.0 : 5.0;
    states[i].y_m = 5.0;
  }

  EXPECT_EQ(channel->publish(states), 700U);

  std::array<int, 700> received_times{};
  for (auto& [cell, reader] : readers) {
    std::vector<CellStatesMessage> batches;
    reader->take(batches);
    for (const auto& batch : batches) {
      EXPECT_EQ((Cell{batch.cell_x, batch.cell_y}), cell);
      EXPECT_LE(batch.states.size(), kMaxCellStates);
      for (const auto& state : batch.states) {
        EXPECT_EQ(cell_of({state.x_m, state.y_m}, kOptions.cell_size_m), cell);
        ++received_times[state.robot_id];
      }
    }
  }
  for (const int times : received_times) EXPECT_EQ(times, 1);
}

TEST_F(TopicChannelTest, LeavesEveryCellWithTheLastRobot) {
  const Vec2 p(30.0, 30.0);
  channel->listen_around({&p, 1});
  channel->listen_around({});
  for (const auto& [cell, writer] : writers) EXPECT_FALSE(listens_to(cell));
}

TEST_F(TopicChannelTest, ReceivesItsOwnStatesOverTheBus) {
  const Vec2 p(30.0, 30.0);
  const RobotStateMessage state{.robot_id = 4, .x_m = p.x(), .y_m = p.y()};
  channel->listen_around({&p, 1});
  channel->publish({&state, 1});

  std::vector<CellStatesMessage> received;
  EXPECT_EQ(channel->take(received), 1U);
  EXPECT_EQ(received.at(0).states, std::vector{state});
  EXPECT_EQ(channel->take(received), 0U);
}

TEST_F(TopicChannelTest, CountsUndecodableSamplesAlsoOfCellsThatItLeft) {
  const Vec2 p(25.0, 25.0), elsewhere(55.0, 55.0);
  channel->listen_around({&p, 1});
  const auto raw = probe->make_writer(raw_topic(cell_topic({2, 2}))).value();
  const std::vector<std::byte> rubbish(9, std::byte{0xAB});
  EXPECT_TRUE(raw->write(rubbish));
  EXPECT_TRUE(raw->write(rubbish));

  std::vector<CellStatesMessage> received;
  EXPECT_EQ(channel->take(received), 0U);
  EXPECT_EQ(channel->undecodable(), 2U);
  channel->listen_around({&elsewhere, 1});
  EXPECT_EQ(channel->undecodable(), 2U);
}

/// Refuses every endpoint while `refuses` is set.
struct ReluctantParticipant final : Participant {
  Result<RawWriterPtr> make_writer(const RawTopic& topic) override {
    if (refuses) return fail(ErrorCode::kEnvironment, "not now");
    return bus->make_writer(topic);
  }
  Result<RawReaderPtr> make_reader(const RawTopic& topic) override {
    if (refuses) return fail(ErrorCode::kEnvironment, "not now");
    return bus->make_reader(topic);
  }
  void receive() override {}
  Result<void> self_check() const override { return {}; }

  explicit ReluctantParticipant(std::unique_ptr<Participant> of_bus) : bus(std::move(of_bus)) {}
  std::unique_ptr<Participant> bus;
  bool refuses = true;
};

TEST_F(TopicChannelTest, TriesEndpointsThatTheBusRefusedAtTheNextCall) {
  ReluctantParticipant reluctant(bus.make_participant());
  const auto sut = make_topic_channel(reluctant, kOptions);
  const Vec2 p(25.0, 25.0);
  const RobotStateMessage state{.x_m = p.x(), .y_m = p.y()};
  sut->listen_around({&p, 1});
  EXPECT_EQ(sut->publish({&state, 1}), 0U) << "what was not sent does not count as sent";
  EXPECT_FALSE(listens_to({2, 2}));

  reluctant.refuses = false;
  sut->listen_around({&p, 1});

  EXPECT_TRUE(listens_to({2, 2}));
  EXPECT_EQ(sut->publish({&state, 1}), 1U);
}

}  // namespace
}  // namespace swarm::link
