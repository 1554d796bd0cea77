// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Behaviour specific to the in-process bus; what it has in common with DDS is in tests/conformance.
#include <gtest/gtest.h>

#include "tests/support/inproc/inproc_bus.hpp"

namespace swarm::link {
namespace {

EventMessage event(std::uint32_t source) { return {.source = source, .code = "test"}; }

TEST(InprocBus, DeliversAtOnceInTheOrderOfWriting) {
  InprocBus bus;
  const auto a = bus.make_participant();
  const auto b = bus.make_participant();
  const auto reader = b->make_reader(event_topic()).value();
  const auto from_a = a->make_writer(event_topic()).value();
  const auto from_b = b->make_writer(event_topic()).value();

  from_a->write(event(1));
  from_b->write(event(2));
  from_a->write(event(3));

  std::vector<EventMessage> received;
  EXPECT_EQ(reader->take(received), 3U);
  EXPECT_EQ(received, (std::vector{event(1), event(2), event(3)}));
  EXPECT_EQ(reader->take(received), 0U);
}

TEST(InprocBus, MayEndBeforeItsEndpoints) {
  auto bus = std::make_unique<InprocBus>();
  const auto participant = bus->make_participant();
  const auto writer = participant->make_writer(event_topic()).value();
  const auto reader = participant->make_reader(event_topic()).value();

  bus.reset();

  EXPECT_TRUE(writer->write(event(1)));
  std::vector<EventMessage> received;
  EXPECT_EQ(reader->take(received), 1U);
}

TEST(InprocBus, KeepsTopicsOfDifferentTypesApart) {
  InprocBus bus;
  const auto participant = bus.make_participant();
  const auto reader =
      participant->make_reader(Topic<CommandMessage>{.name = "same", .qos = {}}).value();
  const auto writer =
      participant->make_writer(Topic<EventMessage>{.name = "same", .qos = {}}).value();

  EXPECT_EQ(reader->matched(), 0);
  EXPECT_EQ(writer->matched(), 0);
}

TEST(InprocBus, GivesALateJoinerThePlansOfAllWriters) {
  InprocBus bus;
  const auto one = bus.make_participant();
  const auto other = bus.make_participant();
  const auto from_one = one->make_writer(plan_topic()).value();
  const auto from_other = other->make_writer(plan_topic()).value();
  from_one->write({.version = 7});
  from_other->write({.version = 8});

  const auto late = one->make_reader(plan_topic()).value();

  std::vector<PlanMessage> plans;
  ASSERT_EQ(late->take(plans), 2U);
  EXPECT_EQ(plans[0].version, 7U);
  EXPECT_EQ(plans[1].version, 8U);
}

}  // namespace
}  // namespace swarm::link
