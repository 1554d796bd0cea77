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

}  // namespace
}  // namespace swarm::link
