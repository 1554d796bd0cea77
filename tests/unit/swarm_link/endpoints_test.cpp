// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Typed endpoints over a backend that the test plays, and the lists of fields they are made of.
#include "swarm_link/endpoints.hpp"

#include <deque>
#include <string>

#include <gtest/gtest.h>

#include "swarm_link/messages.hpp"

namespace swarm::link {
namespace {

using Bytes = std::vector<std::byte>;

struct RawEnd {
  std::deque<Bytes> samples;
  bool refuses = false;
};

class FakeWriter final : public RawWriter {
 public:
  explicit FakeWriter(RawEnd& end) : end_(end) {}
  bool write(std::span<const std::byte> bytes) override {
    if (end_.refuses) return false;
    end_.samples.emplace_back(bytes.begin(), bytes.end());
    return true;
  }
  int matched() const override { return 3; }

 private:
  RawEnd& end_;
};

class FakeReader final : public RawReader {
 public:
  explicit FakeReader(RawEnd& end) : end_(end) {}
  std::size_t take(const Sink& sink) override {
    const std::size_t taken = end_.samples.size();
    for (std::uint64_t sender = 1; !end_.samples.empty(); end_.samples.pop_front()) {
      sink({.bytes = end_.samples.front(), .sender = sender++});
    }
    return taken;
  }
  int matched() const override { return 4; }

 private:
  RawEnd& end_;
};

struct EndpointsTest : testing::Test {
  RawEnd end;
  EncodingWriter<CellStatesMessage> writer{std::make_unique<FakeWriter>(end)};
  DecodingReader<CellStatesMessage> reader{std::make_unique<FakeReader>(end)};

  static CellStatesMessage batch(std::size_t states) {
    CellStatesMessage message{.cell_x = static_cast<std::int32_t>(states)};
    message.states.resize(states);
    return message;
  }
};

TEST_F(EndpointsTest, CarryMessagesOfAnySizeUpToTheBoundInOrder) {
  std::vector<CellStatesMessage> sent;
  for (const std::size_t states : {kMaxCellStates, std::size_t{0}, std::size_t{1}}) {
    sent.push_back(batch(states));
    EXPECT_TRUE(writer.write(sent.back()));
  }

  std::vector<CellStatesMessage> received;
  EXPECT_EQ(reader.take(received), 3U);
  EXPECT_EQ(received, sent);
  EXPECT_EQ(reader.take(received), 0U);
}

TEST_F(EndpointsTest, SendNothingOfAMessageOverItsBound) {
  EXPECT_FALSE(writer.write(batch(kMaxCellStates + 1)));
  EXPECT_TRUE(end.samples.empty());
  EXPECT_TRUE(writer.write(batch(2))) << "the writer goes on";
}

TEST_F(EndpointsTest, ReportARefusalOfTheBackend) {
  end.refuses = true;
  EXPECT_FALSE(writer.write(batch(1)));
}

TEST_F(EndpointsTest, DropAndCountWhatIsNoSampleAndKeepWhatTheCallerHad) {
  EXPECT_TRUE(writer.write(batch(1)));
  end.samples.emplace_back();
  end.samples.push_back(Bytes(7, std::byte{0xAB}));
  EXPECT_TRUE(writer.write(batch(2)));
  std::vector<CellStatesMessage> received = {batch(9)};

  EXPECT_EQ(reader.take(received), 2U);

  EXPECT_EQ(received, (std::vector{batch(9), batch(1), batch(2)}));
  EXPECT_EQ(reader.undecodable(), 2U);
  end.samples.emplace_back();
  EXPECT_EQ(reader.take(received), 0U);
  EXPECT_EQ(reader.undecodable(), 3U) << "since the start";
}

TEST_F(EndpointsTest, NameTheSenderOfEveryMessageThatIsOne) {
  EXPECT_TRUE(writer.write(batch(1)));
  end.samples.push_back(Bytes(7, std::byte{0xAB}));
  EXPECT_TRUE(writer.write(batch(2)));
  std::vector<CellStatesMessage> received = {batch(9)};
  std::vector<std::uint64_t> senders = {77};

  EXPECT_EQ(reader.take_with_senders(received, senders), 2U);

  EXPECT_EQ(received, (std::vector{batch(9), batch(1), batch(2)}));
  EXPECT_EQ(senders, (std::vector<std::uint64_t>{77, 1, 3}));
}

TEST_F(EndpointsTest, HaveTheMatchesOfTheBackend) {
  EXPECT_EQ(writer.matched(), 3);
  EXPECT_EQ(reader.matched(), 4);
}

template <class M>
std::string names_of() {
  std::string names;
  for_each_field<M>([&](auto field) { names += std::string(decltype(field)::kName) + " "; });
  return names;
}

TEST(Fields, HaveTheNamesOfTheirMembersInOrder) {
  EXPECT_EQ(names_of<PointMessage>(), "x_m y_m ");
  EXPECT_EQ(names_of<CellStatesMessage>(), "schema_version cell_x cell_y states ");
  EXPECT_EQ(names_of<EventMessage>(), "schema_version severity source stamp_utc_ns code text ");
}

TEST(Fields, AreVisitedUpToTheFirstThatFails) {
  int visited = 0;
  EXPECT_FALSE(all_fields<CommandMessage>([&](auto field) {
    ++visited;
    return decltype(field)::kName != "kind";
  }));
  EXPECT_EQ(visited, 2);
  EXPECT_TRUE(all_fields<CommandMessage>([](auto) { return true; }));
}

/// Each sequence of a message in turn has one element more than its bound.
template <class M>
void expect_each_bound_kept() {
  EXPECT_TRUE(fits_wire(M()));
  for_each_field<M>([](auto field) {
    using F = decltype(field);
    if constexpr (kIsSequence<typename F::Type>) {
      M message;
      (message.*F::kMember).resize(F::kBound);
      EXPECT_TRUE(fits_wire(message)) << F::kName;
      (message.*F::kMember).resize(F::kBound + 1);
      EXPECT_FALSE(fits_wire(message)) << F::kName;
    }
  });
}

template <class... M>
void expect_all_bounds_kept(MessageList<M...>) {
  (expect_each_bound_kept<M>(), ...);
}

TEST(WireBounds, AreThoseOfEverySequence) { expect_all_bounds_kept(AllMessages()); }

TEST(WireBounds, DoNotRefuseALongText) {
  EXPECT_TRUE(fits_wire(EventMessage{.text = std::string(10'000, 't')}));
}

/// A message as large as its bounds allow.
template <class M>
void expect_buffer_holds_the_largest() {
  M message;
  for_each_field<M>([&](auto field) {
    using F = decltype(field);
    if constexpr (kIsSequence<typename F::Type>) (message.*F::kMember).resize(F::kBound);
    if constexpr (kIsText<typename F::Type>) (message.*F::kMember).assign(F::kBound, 't');
  });
  Bytes bytes;
  ASSERT_TRUE(encode(message, bytes)) << M::kIdlName;
  EXPECT_LE(bytes.size(), raw_topic(Topic<M>{}).usual_bytes) << M::kIdlName;
}

template <class... M>
void expect_all_buffers_hold_the_largest(MessageList<M...>) {
  (expect_buffer_holds_the_largest<M>(), ...);
}

TEST(RawTopic, HasRoomForTheLargestMessage) { expect_all_buffers_hold_the_largest(AllMessages()); }

}  // namespace
}  // namespace swarm::link
