// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Behaviour that all backends of the bus must have in common.
#include <map>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/conformance/bus.hpp"
#include "tests/conformance/samples.hpp"

namespace swarm::link::conformance {
namespace {

class Participants : public testing::TestWithParam<Backend> {
 protected:
  // The next `count` messages that a reader receives.
  template <class M>
  std::vector<M> receive(const ReaderPtr<M>& reader, std::size_t count) {
    std::vector<M> received;
    EXPECT_TRUE(bus->eventually([&] { return reader->take(received), received.size() >= count; }));
    return received;
  }

  template <class W, class R>
  void await_match(const W& writer, const R& reader) {
    ASSERT_TRUE(bus->eventually([&] { return writer->matched() > 0 && reader->matched() > 0; }));
  }

  template <class M>
  void round_trip() {
    Rng rng(1);
    const auto writer = a.make_writer(topic_of<M>()).value();
    const auto reader = b.make_reader(topic_of<M>()).value();
    await_match(writer, reader);
    for (int i = 0; i < 3; ++i) {
      const M sent = sample<M>(rng);
      ASSERT_TRUE(writer->write(sent));
      EXPECT_EQ(receive(reader, 1), std::vector{sent});
    }
    EXPECT_EQ(reader->undecodable(), 0U);
  }

  std::unique_ptr<Bus> bus = GetParam().make();
  Participant& a = bus->participant();
  Participant& b = bus->participant();
};

INSTANTIATE_TEST_SUITE_P(Backends, Participants, testing::ValuesIn(backends()), name_of);

TEST_P(Participants, PassTheirSelfCheck) {
  const auto checked = a.self_check();
  EXPECT_TRUE(checked) << checked.error().message;
}

TEST_P(Participants, CarryPlansUnchanged) { round_trip<PlanMessage>(); }
TEST_P(Participants, CarryScenesUnchanged) { round_trip<SceneMessage>(); }
TEST_P(Participants, CarryHeartbeatsUnchanged) { round_trip<HeartbeatMessage>(); }
TEST_P(Participants, CarryCellStatesUnchanged) { round_trip<CellStatesMessage>(); }
TEST_P(Participants, CarryCommandsUnchanged) { round_trip<CommandMessage>(); }
TEST_P(Participants, CarryStatusUnchanged) { round_trip<StatusMessage>(); }
TEST_P(Participants, CarryEventsUnchanged) { round_trip<EventMessage>(); }

TEST_P(Participants, NameTheSenderOnAllTopics) {
  const auto statuses_of_a = a.make_writer(status_topic()).value();
  const auto events_of_a = a.make_writer(event_topic()).value();
  const auto events_of_b = b.make_writer(event_topic()).value();
  const auto statuses = b.make_reader(status_topic()).value();
  const auto events = b.make_reader(event_topic()).value();
  ASSERT_TRUE(bus->eventually([&] {
    return statuses_of_a->matched() == 1 && events_of_a->matched() == 1 &&
           events_of_b->matched() == 1 && statuses->matched() == 1 && events->matched() == 2;
  }));
  const auto sender = [&](const auto& writer, const auto& reader, const auto& message) {
    EXPECT_TRUE(writer->write(message));
    std::vector<std::decay_t<decltype(message)>> received;
    std::vector<std::uint64_t> senders;
    EXPECT_TRUE(bus->eventually([&] {
      reader->take_with_senders(received, senders);
      return !senders.empty();
    }));
    return senders.empty() ? 0 : senders.front();
  };
  const std::uint64_t sender_a = sender(statuses_of_a, statuses, StatusMessage{});
  EXPECT_NE(sender_a, 0U);
  EXPECT_EQ(sender(events_of_a, events, EventMessage{}), sender_a);
  EXPECT_NE(sender(events_of_b, events, EventMessage{}), sender_a);
}

TEST_P(Participants, MatchExactlyWhereTheWriterOffersWhatTheReaderAsksFor) {
  struct Pair {
    WriterPtr<CommandMessage> writer;
    ReaderPtr<CommandMessage> reader;
    bool compatible;
  };
  std::vector<Pair> pairs;
  for (int bits = 0; bits < 16; ++bits) {
    const auto qos = [](int mask) {
      return Qos{.reliability = mask & 1 ? Reliability::kReliable : Reliability::kBestEffort,
                 .durability = mask & 2 ? Durability::kTransientLocal : Durability::kVolatile};
    };
    const int offered = bits & 3;
    const int asked = bits >> 2;
    const auto name = fmt::format("qos/{}_{}", offered, asked);
    pairs.push_back({.writer = a.make_writer(Topic<CommandMessage>{name, qos(offered)}).value(),
                     .reader = b.make_reader(Topic<CommandMessage>{name, qos(asked)}).value(),
                     .compatible = (~offered & asked & 3) == 0});
  }

  for (const auto& pair : pairs) {
    if (!pair.compatible) continue;
    await_match(pair.writer, pair.reader);
    ASSERT_TRUE(pair.writer->write({.command_id = 5}));
    EXPECT_EQ(receive(pair.reader, 1), std::vector{CommandMessage{.command_id = 5}});
  }
  for (const auto& pair : pairs) {
    EXPECT_EQ(pair.writer->matched(), pair.compatible ? 1 : 0);
    EXPECT_EQ(pair.reader->matched(), pair.compatible ? 1 : 0);
  }
}

TEST_P(Participants, ReceiveTheirOwnMessages) {
  const auto writer = a.make_writer(cell_topic({0, 0})).value();
  const auto reader = a.make_reader(cell_topic({0, 0})).value();
  await_match(writer, reader);
  writer->write({.cell_x = 1});
  EXPECT_EQ(receive(reader, 1), std::vector{CellStatesMessage{.cell_x = 1}});
}

TEST_P(Participants, CarryTheLargestPlanInOnePiece) {
  Rng rng(2);
  const auto plan = plan_of_size(rng, 4096, 8192);  // about 360 kB: six datagrams
  const auto writer = a.make_writer(plan_topic()).value();
  const auto reader = b.make_reader(plan_topic()).value();
  await_match(writer, reader);
  ASSERT_TRUE(writer->write(plan));
  EXPECT_EQ(receive(reader, 1), std::vector{plan});
}

TEST_P(Participants, RefuseToWriteMoreThanTheContractAllows) {
  Rng rng(3);
  const auto plans = a.make_writer(plan_topic()).value();
  EXPECT_FALSE(plans->write(plan_of_size(rng, 4097, 0)));
  EXPECT_FALSE(plans->write(plan_of_size(rng, 0, 8193)));
  const auto cells = a.make_writer(cell_topic({0, 0})).value();
  EXPECT_FALSE(cells->write({.states = std::vector<RobotStateMessage>(257)}));
  const auto status = a.make_writer(status_topic()).value();
  EXPECT_FALSE(status->write({.robots = std::vector<RobotStatusMessage>(101)}));
  EXPECT_FALSE(status->write({.refused = std::vector<std::uint32_t>(17)}));
  EXPECT_FALSE(status->write({.state_age = std::vector<HistogramBinMessage>(465)}));
}

TEST_P(Participants, CutLongEventTexts) {
  const auto writer = a.make_writer(event_topic()).value();
  const auto reader = b.make_reader(event_topic()).value();
  await_match(writer, reader);
  ASSERT_TRUE(writer->write({.code = std::string(70, 'c'), .text = std::string(2000, 't')}));
  const EventMessage cut{.code = std::string(64, 'c'), .text = std::string(512, 't')};
  EXPECT_EQ(receive(reader, 1), std::vector{cut});
}

TEST_P(Participants, GiveLateJoinersThePlan) {
  Rng rng(4);
  const auto first = plan_of_size(rng, 2, 2);
  const auto second = plan_of_size(rng, 4096, 8192);
  const auto writer = a.make_writer(plan_topic()).value();
  writer->write(first);
  writer->write(second);

  const auto late = b.make_reader(plan_topic()).value();

  EXPECT_EQ(receive(late, 1), std::vector{second});
}

TEST_P(Participants, GiveLateJoinersAllCommandsInOrder) {
  const auto writer = a.make_writer(command_topic()).value();
  std::vector<CommandMessage> commands;
  for (std::uint64_t i = 0; i < 32; ++i) commands.push_back({.command_id = i});
  for (const auto& command : commands) ASSERT_TRUE(writer->write(command));

  const auto late = b.make_reader(command_topic()).value();

  EXPECT_EQ(receive(late, commands.size()), commands);
}

TEST_P(Participants, GiveLateJoinersNothingVolatile) {
  const Topic<EventMessage> topic{"test/volatile", {.depth = 8}};
  const auto writer = a.make_writer(topic).value();
  writer->write({.source = 1});

  const auto late = b.make_reader(topic).value();
  await_match(writer, late);
  writer->write({.source = 2});

  EXPECT_EQ(receive(late, 1), std::vector{EventMessage{.source = 2}});
}

TEST_P(Participants, KeepTheLastOfEachGroupsStatus) {
  auto topic = status_topic();
  topic.qos.reader_depth = 1;
  auto deep_topic = status_topic();
  deep_topic.qos.depth = 3;
  const auto writer = a.make_writer(deep_topic).value();
  const auto reader = b.make_reader(topic).value();
  const auto deep = b.make_reader(deep_topic).value();  // shows when all have arrived
  await_match(writer, deep);
  ASSERT_TRUE(bus->eventually([&] { return writer->matched() == 2; }));
  constexpr std::uint32_t kGroups = 150;
  for (std::uint32_t version = 1; version <= 3; ++version) {
    for (std::uint32_t id = 0; id < kGroups; ++id) {
      writer->write({.first_robot_id = id, .plan_version = version});
    }
  }
  ASSERT_EQ(receive(deep, 3 * kGroups).size(), 3 * kGroups);
  bus->converge();

  std::vector<StatusMessage> last;
  reader->take(last);

  std::map<std::uint32_t, std::uint32_t> version_of;
  for (const auto& status : last) version_of[status.first_robot_id] = status.plan_version;
  EXPECT_EQ(last.size(), kGroups);
  EXPECT_EQ(version_of.size(), kGroups);
  for (const auto& [id, version] : version_of) EXPECT_EQ(version, 3U);
}

TEST_P(Participants, KeepTheLastOfManyCellBatches) {
  const auto topic = cell_topic({0, 0});
  const auto writer = a.make_writer(topic).value();
  const auto reader = b.make_reader(topic).value();
  await_match(writer, reader);
  for (std::int32_t i = 0; i < 200; ++i) writer->write({.cell_x = i});
  bus->converge();

  std::vector<CellStatesMessage> received;
  ASSERT_TRUE(bus->eventually([&] { return reader->take(received) > 0; }));

  EXPECT_LE(received.size(), static_cast<std::size_t>(topic.qos.depth));
  EXPECT_EQ(received.back().cell_x, 199);
}

TEST_P(Participants, NoticeWhenWritersAndReadersGo) {
  auto writer = a.make_writer(command_topic()).value();
  auto reader = b.make_reader(command_topic()).value();
  await_match(writer, reader);
  writer->write({.command_id = 1});
  EXPECT_EQ(receive(reader, 1).size(), 1U);

  writer.reset();
  EXPECT_TRUE(bus->eventually([&] { return reader->matched() == 0; }));

  writer = a.make_writer(command_topic()).value();
  await_match(writer, reader);
  reader.reset();
  EXPECT_TRUE(bus->eventually([&] { return writer->matched() == 0; }));
}

TEST_P(Participants, DropTheSamplesOfAWriterThatEnded) {
  auto gone = a.make_writer(command_topic()).value();
  gone->write({.command_id = 1});
  gone.reset();
  const auto writer = a.make_writer(command_topic()).value();
  writer->write({.command_id = 2});

  const auto late = b.make_reader(command_topic()).value();

  EXPECT_EQ(receive(late, 1), std::vector{CommandMessage{.command_id = 2}});
}

TEST_P(Participants, ReceiveAPlanAlthoughAnotherWriterPublishesJustBehindIt) {
  const auto planner = a.make_writer(plan_topic()).value();
  const auto other = bus->participant().make_writer(plan_topic()).value();
  const auto reader = b.make_reader(plan_topic()).value();
  ASSERT_TRUE(bus->eventually([&] { return reader->matched() == 2; }));
  await_match(planner, reader);
  await_match(other, reader);

  planner->write({.version = 1});
  bus->converge();
  other->write({.version = 2});
  bus->converge();

  EXPECT_EQ(receive(reader, 2),
            (std::vector{PlanMessage{.version = 1}, PlanMessage{.version = 2}}));
}

TEST_P(Participants, SurviveEndpointsThatComeAndGo) {
  const auto stay = a.make_writer(cell_topic({0, 0})).value();
  for (int i = 0; i < 200; ++i) {
    const Cell cell{i % 5, i % 3};
    const auto writer = b.make_writer(cell_topic(cell)).value();
    const auto reader = b.make_reader(cell_topic(cell)).value();
    writer->write({.cell_x = cell.x});
    bus->pump();
  }
  const auto reader = b.make_reader(cell_topic({0, 0})).value();
  await_match(stay, reader);
  stay->write({.cell_x = 7});
  EXPECT_EQ(receive(reader, 1), std::vector{CellStatesMessage{.cell_x = 7}});
}

}  // namespace
}  // namespace swarm::link::conformance
