// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/gateway/gateway_inbox.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::link {
namespace {

constexpr UtcTime kNow{std::chrono::seconds(1'700'000'000)};

WireLimits limits() {
  return {.robots = 10,
          .bounds_m = {.min_m = {0.0, 0.0}, .max_m = {50.0, 40.0}},
          .clock_skew_refuse = std::chrono::seconds(10)};
}

RobotStateMessage state(std::uint32_t robot, std::int64_t ms) {
  return {.robot_id = robot,
          .sequence_number = static_cast<std::uint32_t>(ms),
          .stamp_utc_ns = (kNow + std::chrono::milliseconds(ms)).time_since_epoch().count(),
          .x_m = 5.0,
          .y_m = 5.0};
}

std::vector<RobotStateMessage> fresh(GatewayInbox& sut,
                                     const std::vector<CellStatesMessage>& batches) {
  std::vector<RobotStateMessage> out;
  sut.take_fresh(batches, kNow, out);
  return out;
}

TEST(GatewayInbox, DropsTheRefusedStateAndKeepsTheRestOfItsBatch) {
  GatewayInbox sut(limits());
  EXPECT_EQ(fresh(sut, {{.states = {state(1, 0), state(10, 0), state(2, 0)}}}),
            (std::vector{state(1, 0), state(2, 0)}));
  EXPECT_EQ(sut.refused()[RefusalReason::kOutOfRange], 1U);
}

TEST(GatewayInbox, DropsABatchOfAnotherSchemaAsAWhole) {
  GatewayInbox sut(limits());
  EXPECT_TRUE(
      fresh(sut, {{.schema_version = kSchemaVersion + 1, .states = {state(1, 0)}}}).empty());
  EXPECT_EQ(sut.refused()[RefusalReason::kSchema], 1U);
  EXPECT_EQ(fresh(sut, {{.states = {state(1, 0)}}}).size(), 1U) << "its states were not recorded";
}

TEST(GatewayInbox, AppendsToWhatTheCallerHas) {
  GatewayInbox sut(limits());
  std::vector<RobotStateMessage> out = {state(9, 0)};
  const std::vector<CellStatesMessage> batches = {{.states = {state(1, 0)}}, {}};
  sut.take_fresh(batches, kNow, out);
  EXPECT_EQ(out, (std::vector{state(9, 0), state(1, 0)}));
}

// What is forwarded comes back from both channels, late and more than once.
TEST(GatewayInbox, ForwardsEachStateOnceAmongItsEchoes) {
  Rng rng(71);
  GatewayInbox sut(limits());
  std::vector<RobotStateMessage> forwarded;
  std::uint64_t echoes = 0;
  for (std::int64_t ms = -2'000; ms < 0; ++ms) {
    CellStatesMessage batch;
    batch.states.push_back(state(static_cast<std::uint32_t>(rng() % 10), ms));
    for (std::size_t i = rng() % 4; i > 0 && !forwarded.empty(); --i) {
      batch.states.push_back(forwarded[rng() % forwarded.size()]);
      ++echoes;
    }

    const auto out = fresh(sut, {batch});

    ASSERT_EQ(out, std::vector{batch.states[0]});
    forwarded.push_back(out[0]);
  }
  const RefusalCounters& refused = sut.refused();
  EXPECT_EQ(refused[RefusalReason::kDuplicate] + refused[RefusalReason::kStale], echoes);
  EXPECT_EQ(refused.total(), echoes);
}

TEST(GatewayInbox, CountsWhatDidNotDecode) {
  GatewayInbox sut(limits());
  sut.set_undecodable(4);
  sut.set_undecodable(4);
  EXPECT_EQ(sut.refused()[RefusalReason::kUndecodable], 4U);
}

}  // namespace
}  // namespace swarm::link
