// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The gate under random streams, against what its header promises of them.
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_core/base/stamp.hpp"
#include "swarm_link/gate/gate.hpp"
#include "swarm_link/gate/number_tests.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::link {
namespace {

constexpr UtcTime kNow{std::chrono::seconds(1'700'000'000)};
constexpr std::int64_t kNow_ns = kNow.time_since_epoch().count();
constexpr std::int64_t kRefuse_ns = 10'000'000'000;

WireLimits limits() {
  return {.robots = 20,
          .bounds_m = {.min_m = {0.0, 0.0}, .max_m = {50.0, 40.0}},
          .bounds_slack_m = 5.0,
          .clock_skew_warn = std::chrono::milliseconds(250),
          .clock_skew_refuse = Duration(kRefuse_ns)};
}

/// A stamp near the limits of what is refused, or any.
std::int64_t any_stamp(Rng& rng) {
  constexpr std::array<std::int64_t, 6> kAround = {-kRefuse_ns, 0, kRefuse_ns,
                                                   -kNow_ns,    1, 3'000'000'000};
  if (rng() % 8 == 0) return static_cast<std::int64_t>(rng());
  return kNow_ns + kAround[rng() % kAround.size()] + static_cast<std::int64_t>(rng() % 5) - 2;
}

TEST(Gate, PassesCommandsAsTheModelDoes) {
  Rng rng(51);
  for (int round = 0; round < 50; ++round) {
    Gate sut{{.limits = limits()}};
    std::uint64_t newest = 0;
    std::uint64_t refused = 0;
    for (int i = 0; i < 400; ++i) {
      const auto kind = static_cast<CommandKind>(rng() % 5);  // one too many
      const CommandMessage message{.kind = kind,
                                   .command_id = static_cast<std::uint64_t>(any_stamp(rng)),
                                   .stamp_utc_ns = any_stamp(rng)};
      const bool reachable =
          message.command_id <= static_cast<std::uint64_t>(kNow_ns + kRefuse_ns) &&
          message.stamp_utc_ns <= kNow_ns + kRefuse_ns && message.stamp_utc_ns >= -kStampLimit_ns;
      const bool stop = kind == CommandKind::kStop;
      const bool expected =
          stop || (kind < CommandKind::kStop && reachable && message.command_id > newest);

      ASSERT_EQ(sut.command(message, kNow).has_value(), expected);

      if (expected && !stop) newest = message.command_id;
      refused += expected ? 0 : 1;
      ASSERT_EQ(sut.refused().total(), refused) << "each refusal counts once";
    }
  }
}

HeartbeatMessage heartbeat(std::uint64_t epoch, std::uint64_t number) {
  return {.epoch = epoch, .sequence_number = number, .stamp_utc_ns = kNow_ns};
}

// Two planners whose heartbeats arrive in any order: a receiver follows the one that it receives
// first, ends with the newest of that one, and on the path to it never goes back.
TEST(Gate, EndsWithTheNewestHeartbeatInWhateverOrderTheyArrive) {
  Rng rng(52);
  const std::uint64_t first = kNow_ns - 50'000'000'000, second = first + 1;
  std::vector<HeartbeatMessage> all;
  for (std::uint64_t number = 1; number <= 20; ++number) {
    all.push_back(heartbeat(first, number));
    all.push_back(heartbeat(second, number));
  }
  for (int round = 0; round < 200; ++round) {
    std::shuffle(all.begin(), all.end(), rng);
    Gate sut{{.limits = limits()}};
    std::uint64_t last = 0;
    for (const HeartbeatMessage& message : all) {
      if (!sut.heartbeat(message, kNow)) continue;
      ASSERT_EQ(message.epoch, all.front().epoch);
      ASSERT_GT(message.sequence_number, last);
      last = message.sequence_number;
    }
    EXPECT_EQ(last, 20U);
    EXPECT_EQ(sut.foreign_heartbeats(), 20U);
  }
}

TEST(Gate, PassesEachStateOnceAsTheModelDoes) {
  Rng rng(53);
  Gate sut{{.limits = limits()}};
  std::map<std::uint32_t, std::int64_t> newest;
  int passed = 0;
  for (int i = 0; i < 20'000; ++i) {
    const RobotStateMessage state{.robot_id = static_cast<std::uint32_t>(rng() % 21),
                                  .stamp_utc_ns = any_stamp(rng),
                                  .x_m = 5.0,
                                  .y_m = 5.0};
    const bool near =
        state.stamp_utc_ns >= kNow_ns - kRefuse_ns && state.stamp_utc_ns <= kNow_ns + 1'000'000'000;
    const bool newer =
        !newest.contains(state.robot_id) || state.stamp_utc_ns > newest[state.robot_id];
    const bool expected = state.robot_id < 20 && near && newer;

    ASSERT_EQ(sut.newer_state(state, kNow).has_value(), expected);

    if (expected) newest[state.robot_id] = state.stamp_utc_ns;
    passed += expected ? 1 : 0;
  }
  EXPECT_EQ(sut.refused().total() + static_cast<std::uint64_t>(passed), 20'000U);
  EXPECT_GT(passed, 20);
}

// A recording may be older than the epoch of the clock, or hold rubbish.
TEST(Gate, ReplaysStatesOfAnyAge) {
  Gate replay{{.limits = limits(), .stamps = Stamps::kRecorded}};
  const auto passes = [&](std::int64_t stamp_utc_ns) {
    return replay.state({.robot_id = 1, .stamp_utc_ns = stamp_utc_ns, .x_m = 5.0, .y_m = 5.0}, kNow)
        .has_value();
  };
  EXPECT_TRUE(passes(std::numeric_limits<std::int64_t>::min()));
  EXPECT_TRUE(passes(0));
  EXPECT_TRUE(passes(kNow_ns + kRefuse_ns));
  EXPECT_FALSE(passes(kNow_ns + kRefuse_ns + 1));
  EXPECT_FALSE(passes(std::numeric_limits<std::int64_t>::max()));
}

TEST(Gate, CountsUndecodableSamplesAsTheyGrow) {
  Gate sut{{.limits = limits()}};
  std::uint64_t so_far = 0;
  for (const std::uint64_t more : {0U, 1U, 0U, 5U, 100'000U}) {
    so_far += more;
    sut.set_undecodable(so_far);
    EXPECT_EQ(sut.refused()[RefusalReason::kUndecodable], so_far);
  }
}

TEST(EchoGuard, KnowsAnEchoAcrossTheWrapOfTheNumbers) {
  EchoGuard sut;
  std::vector<RobotStateMessage> sent;
  for (std::uint32_t i = 0; i < 64; ++i) {
    sent.push_back({.sequence_number = std::numeric_limits<std::uint32_t>::max() - 31 + i,
                    .stamp_utc_ns = kNow_ns + i});
    sut.record_sent(sent.back());
  }
  for (const RobotStateMessage& state : sent) EXPECT_TRUE(sut.is_echo(state));
  std::swap(sent[0].stamp_utc_ns, sent[1].stamp_utc_ns);
  EXPECT_FALSE(sut.is_echo(sent[0])) << "the stamp of another one";
}

TEST(NumberTests, FindAnyNumberThatIsNotFinite) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(all_finite(0.0, -1e308, std::numeric_limits<double>::denorm_min()));
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_FALSE(all_finite(bad, 1.0, 2.0));
    EXPECT_FALSE(all_finite(1.0, bad, 2.0));
    EXPECT_FALSE(all_finite(1.0, 2.0, bad));
  }
}

TEST(NumberTests, MeasureTheSlackFromTheNearestPointOfTheBounds) {
  Rng rng(54);
  for (int i = 0; i < 20'000; ++i) {
    const double x = uniform(rng, -10.0, 60.0), y = uniform(rng, -10.0, 50.0);
    const double dx = x - std::clamp(x, 0.0, 50.0), dy = y - std::clamp(y, 0.0, 40.0);
    EXPECT_EQ(is_inside(x, y, limits()), dx * dx + dy * dy <= 25.0);
  }
  EXPECT_TRUE(is_inside(55.0, 20.0, limits()));
  EXPECT_FALSE(is_inside(54.0, 44.0, limits())) << "a corner of the slack is round";
}

TEST(WireLimits, AreThoseOfTheMission) {
  Mission mission;
  mission.world = World::make({{1.0, 2.0}, {30.0, 40.0}}, {}).value();
  mission.robots.count = 7;
  mission.robots.speed_max_mps = 2.5;
  mission.timing.clock_skew_warn_s = 0.125;
  mission.timing.clock_skew_refuse_s = 1.5;

  const WireLimits of_mission = wire_limits(mission);

  EXPECT_EQ(of_mission.robots, 7U);
  EXPECT_EQ(of_mission.speed_max_mps, 2.5);
  EXPECT_EQ(of_mission.clock_skew_warn, std::chrono::milliseconds(125));
  EXPECT_EQ(of_mission.clock_skew_refuse, std::chrono::milliseconds(1500));
  EXPECT_EQ(of_mission.bounds_m.min_m, Vec2(1.0, 2.0));
  EXPECT_EQ(of_mission.bounds_m.max_m, Vec2(30.0, 40.0));
}

TEST(WireLimits, HaveTheSpeedOfTheFastestGroup) {
  Mission mission;
  mission.robots.count = 7;
  mission.robots.speed_max_mps = 1.0;
  RobotGroupSpec fast;
  fast.count = 2;
  fast.speed_max_mps = 4.0;
  mission.robots.groups = {fast};

  EXPECT_EQ(wire_limits(mission).speed_max_mps, 4.0);
}

}  // namespace
}  // namespace swarm::link
