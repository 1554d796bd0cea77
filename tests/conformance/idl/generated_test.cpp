// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Compares our bytes with those of the code that a vendor's generator makes of the IDL.
#include <algorithm>

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <gtest/gtest.h>

#include "swarm.h"
#include "swarm_link/cdr/codec.hpp"
#include "tests/conformance/samples.hpp"

namespace swarm::link::conformance {
namespace {

using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;
using Bytes = std::vector<std::byte>;

/// The generated type writes what it is; `endianness` as on either machine.
template <class Wire>
Bytes written(const Wire& wire, Cdr::Endianness endianness) {
  Bytes bytes(4 + Wire::getCdrSerializedSize(wire));
  FastBuffer buffer(reinterpret_cast<char*>(bytes.data()), bytes.size());
  Cdr stream(buffer, endianness, Cdr::DDS_CDR);
  stream.serialize_encapsulation();
  wire.serialize(stream);
  bytes.resize(stream.getSerializedDataLength());
  return bytes;
}

template <class Wire>
Wire read(Bytes bytes) {
  FastBuffer buffer(reinterpret_cast<char*>(bytes.data()), bytes.size());
  Cdr stream(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
  stream.read_encapsulation();
  Wire wire;
  wire.deserialize(stream);
  return wire;
}

/// \pre names, order and types are those of the IDL: idl_text_test.cpp
template <class M, class Wire>
void expect_same_bytes() {
  Rng rng(7);
  for (int i = 0; i < 20; ++i) {
    const M message = sample<M>(rng);
    Bytes ours;
    ASSERT_TRUE(encode(message, ours));

    const Wire wire = read<Wire>(ours);

    EXPECT_EQ(written(wire, Cdr::LITTLE_ENDIANNESS), ours);
    M back;
    ASSERT_TRUE(decode(ours, back));
    EXPECT_EQ(back, message);
    ASSERT_TRUE(decode(written(wire, Cdr::BIG_ENDIANNESS), back));
    EXPECT_EQ(back, message);
  }
}

TEST(OurBytes, AreThoseOfTheGeneratedCode) {
  expect_same_bytes<PlanMessage, wire::FlowPlan>();
  expect_same_bytes<SceneMessage, wire::Scene>();
  expect_same_bytes<HeartbeatMessage, wire::Heartbeat>();
  expect_same_bytes<CellStatesMessage, wire::CellStates>();
  expect_same_bytes<CommandMessage, wire::Command>();
  expect_same_bytes<StatusMessage, wire::Status>();
  expect_same_bytes<EventMessage, wire::Event>();
}

TEST(OurBytes, NeedTheLargestRoomThatIsForeseen) {
  EXPECT_GE(cdr::most_bytes<CellStatesMessage>(), wire::CellStates::getMaxCdrSerializedSize());
  EXPECT_GE(cdr::most_bytes<EventMessage>(), wire::Event::getMaxCdrSerializedSize());
}

static_assert(kSchemaVersion == wire::SCHEMA_VERSION && kNoRobot == wire::NO_ROBOT);

}  // namespace
}  // namespace swarm::link::conformance
