// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/roles/relay_participant.hpp"

#include <gtest/gtest.h>

#include "tests/support/inproc/inproc_bus.hpp"

namespace swarm::link {
namespace {

/// Two buses that do not receive each other, and a participant that belongs to both.
struct RelayParticipant : testing::Test {
  std::unique_ptr<Participant> both() {
    std::vector<std::unique_ptr<Participant>> members;
    members.push_back(left.make_participant());
    members.push_back(right.make_participant());
    return make_relay_participant(std::move(members));
  }

  InprocBus left;
  InprocBus right;
  std::unique_ptr<Participant> in_left = left.make_participant();
  std::unique_ptr<Participant> in_right = right.make_participant();
  std::unique_ptr<Participant> relay = both();
};

TEST_F(RelayParticipant, PublishesThroughBothParticipants) {
  const auto writer = relay->make_writer(command_topic()).value();
  const auto left_reader = in_left->make_reader(command_topic()).value();
  const auto right_reader = in_right->make_reader(command_topic()).value();

  EXPECT_TRUE(writer->write({.command_id = 7}));

  std::vector<CommandMessage> received;
  EXPECT_EQ(left_reader->take(received), 1U);
  EXPECT_EQ(right_reader->take(received), 1U);
  EXPECT_EQ(received, (std::vector<CommandMessage>{{.command_id = 7}, {.command_id = 7}}));
  EXPECT_EQ(writer->matched(), 2);
}

TEST_F(RelayParticipant, ReceivesFromBothParticipantsWhichDoNotReceiveEachOther) {
  const auto reader = relay->make_reader(event_topic()).value();
  const auto left_writer = in_left->make_writer(event_topic()).value();
  const auto right_writer = in_right->make_writer(event_topic()).value();
  const auto right_reader = in_right->make_reader(event_topic()).value();

  left_writer->write({.source = 1});

  std::vector<EventMessage> received;
  EXPECT_EQ(right_reader->take(received), 0U);
  right_writer->write({.source = 2});
  EXPECT_EQ(reader->take(received), 2U);
  EXPECT_EQ(received, (std::vector<EventMessage>{{.source = 1}, {.source = 2}}));
  EXPECT_EQ(reader->matched(), 2);
  EXPECT_EQ(reader->undecodable(), 0U);
}

/// A participant of a vendor in trouble.
struct FailingParticipant final : Participant {
  Result<RawWriterPtr> make_writer(const RawTopic&) override {
    return fail(ErrorCode::kEnvironment, "no writer");
  }
  Result<RawReaderPtr> make_reader(const RawTopic&) override {
    return fail(ErrorCode::kEnvironment, "no reader");
  }
  void receive() override { ++*received; }
  Result<void> self_check() const override {
    return fail(ErrorCode::kEnvironment, "cannot receive");
  }
  explicit FailingParticipant(int& calls) : received(&calls) {}
  int* received;
};

TEST(RelayParticipantOfAFailingOne, FailsWithItsReason) {
  InprocBus bus;
  int received = 0;
  std::vector<std::unique_ptr<Participant>> members;
  members.push_back(bus.make_participant());
  members.push_back(std::make_unique<FailingParticipant>(received));
  members.push_back(std::make_unique<FailingParticipant>(received));
  const auto relay = make_relay_participant(std::move(members));

  EXPECT_EQ(relay->make_writer(raw_topic(event_topic())).error().message, "no writer");
  EXPECT_EQ(relay->make_reader(raw_topic(event_topic())).error().message, "no reader");
  EXPECT_EQ(relay->self_check().error().message, "cannot receive");
  relay->receive();
  EXPECT_EQ(received, 2) << "each participant receives";
  const auto probe = bus.make_participant();
  EXPECT_EQ(probe->make_reader(event_topic()).value()->matched(), 0)
      << "no half of a writer is left";
}

TEST(RelayParticipantOfOne, IsThatOne) {
  InprocBus bus;
  std::vector<std::unique_ptr<Participant>> members;
  members.push_back(bus.make_participant());
  const Participant* only = members.front().get();
  EXPECT_EQ(make_relay_participant(std::move(members)).get(), only);
}

}  // namespace
}  // namespace swarm::link
