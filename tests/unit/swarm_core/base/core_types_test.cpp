// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The smallest types of the public headers: ids, times, results, phases.
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <unordered_set>

#include <gtest/gtest.h>

#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/strong_id.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/phase.hpp"

namespace swarm {
namespace {

using Id = StrongId<struct IdTag, std::uint32_t>;
using OtherId = StrongId<struct OtherIdTag, std::uint32_t>;

TEST(StrongId, IsNoOtherIdAndNoInteger) {
  static_assert(!std::is_convertible_v<std::uint32_t, Id>);
  static_assert(!std::is_convertible_v<Id, std::uint32_t>);
  static_assert(!std::is_constructible_v<Id, OtherId>);
  static_assert(!std::is_assignable_v<Id&, OtherId>);
  static_assert(std::is_constructible_v<Id, std::uint32_t>);
  static_assert(sizeof(Id) == sizeof(std::uint32_t) && std::is_trivially_copyable_v<Id>);

  EXPECT_EQ(Id().value(), 0U);
  EXPECT_EQ(Id(7).value(), 7U);
}

TEST(StrongId, IsOrderedAndHashedByItsNumber) {
  const std::array<std::uint32_t, 5> numbers{0, 1, 2, 0x7FFF'FFFF, 0xFFFF'FFFF};
  std::unordered_set<Id> set;
  for (const std::uint32_t a : numbers) {
    for (const std::uint32_t b : numbers) {
      EXPECT_EQ(Id(a) < Id(b), a < b);
      EXPECT_EQ(Id(a) == Id(b), a == b);
    }
    EXPECT_TRUE(set.insert(Id(a)).second);
    EXPECT_FALSE(set.insert(Id(a)).second);
    EXPECT_EQ(std::hash<Id>{}(Id(a)), std::hash<std::uint32_t>{}(a));
  }
  EXPECT_EQ(set.count(Id(3)), 0U);
}

TEST(Seconds, AreRoundedToTheNearestNanosecond) {
  EXPECT_EQ(from_seconds(0.0), Duration(0));
  EXPECT_EQ(from_seconds(1.0), Duration(1'000'000'000));
  EXPECT_EQ(from_seconds(0.1), Duration(100'000'000));
  EXPECT_EQ(from_seconds(0.4e-9), Duration(0));
  EXPECT_EQ(from_seconds(0.6e-9), Duration(1));
  EXPECT_EQ(from_seconds(-0.6e-9), Duration(-1));
  EXPECT_EQ(from_seconds(-2.5), Duration(-2'500'000'000));
}

TEST(Seconds, ReadBackAsTheSameDuration) {
  for (std::int64_t ns = 1; ns < 4'000'000'000'000'000; ns = 3 * ns + 1) {
    EXPECT_EQ(from_seconds(to_seconds(Duration(ns))), Duration(ns));
    EXPECT_EQ(from_seconds(to_seconds(Duration(-ns))), Duration(-ns));
  }
}

TEST(PositivePart, IsTheNumberOrZero) {
  for (const double x : {0.0, 1e-300, 1.5, 1e300}) {
    EXPECT_EQ(positive_part(x), x);
    EXPECT_EQ(positive_part(-x), 0.0);
  }
}

TEST(ExitCode, DependsOnTheKindOfError) {
  EXPECT_EQ(static_cast<int>(exit_code(ErrorCode::kBadInput)), 3);
  EXPECT_EQ(static_cast<int>(exit_code(ErrorCode::kInfeasible)), 1);
  EXPECT_EQ(static_cast<int>(exit_code(ErrorCode::kEnvironment)), 2);
  // No error ends with the code of success.
  for (const ErrorCode code :
       {ErrorCode::kBadInput, ErrorCode::kInfeasible, ErrorCode::kEnvironment}) {
    EXPECT_NE(exit_code(code), ExitCode::kOk);
  }
}

TEST(Fail, BecomesAResultOfAnyType) {
  const auto refuse = []() -> Result<std::string> {
    return fail(ErrorCode::kInfeasible, "no plan");
  };
  const auto refuse_void = []() -> Result<void> { return fail(ErrorCode::kEnvironment, "full"); };

  ASSERT_FALSE(refuse().has_value());
  EXPECT_EQ(refuse().error().code, ErrorCode::kInfeasible);
  EXPECT_EQ(refuse().error().message, "no plan");
  ASSERT_FALSE(refuse_void().has_value());
  EXPECT_EQ(refuse_void().error().message, "full");
}

constexpr std::array kPhases{MissionPhase::kReady, MissionPhase::kRunning, MissionPhase::kPaused,
                             MissionPhase::kStopped};
constexpr std::array kCommands{CommandKind::kStart, CommandKind::kPause, CommandKind::kResume,
                               CommandKind::kStop};

// The whole table: a row for each phase, a column for each command.
TEST(PhaseAfter, IsThatOfTheTable) {
  using enum MissionPhase;
  constexpr MissionPhase kAfter[4][4] = {//  start     pause     resume    stop
                                         {kRunning, kReady, kReady, kStopped},       // ready
                                         {kRunning, kPaused, kRunning, kStopped},    // running
                                         {kPaused, kPaused, kRunning, kStopped},     // paused
                                         {kStopped, kStopped, kStopped, kStopped}};  // stopped
  for (std::size_t p = 0; p < 4; ++p) {
    for (std::size_t c = 0; c < 4; ++c) {
      EXPECT_EQ(phase_after(kPhases[p], kCommands[c]), kAfter[p][c])
          << to_string(kPhases[p]) << ' ' << to_string(kCommands[c]);
    }
  }
}

// A command that is received twice, as a repeated stop, is as good as once.
TEST(PhaseAfter, IsTheSameForARepeatedCommand) {
  for (const MissionPhase phase : kPhases) {
    for (const CommandKind kind : kCommands) {
      EXPECT_EQ(phase_after(phase_after(phase, kind), kind), phase_after(phase, kind));
    }
  }
}

TEST(Names, OfPhasesCommandsAndModesAreAllDifferent) {
  std::unordered_set<std::string> names;
  for (const MissionPhase phase : kPhases) names.emplace(to_string(phase));
  EXPECT_EQ(names.size(), 4U);
  names.clear();
  for (const CommandKind kind : kCommands) names.emplace(to_string(kind));
  EXPECT_EQ(names.size(), 4U);
  names.clear();
  for (std::uint8_t mode = 0; mode <= 4; ++mode) {
    names.emplace(to_string(static_cast<RobotMode>(mode)));
  }
  EXPECT_EQ(names.size(), 5U);
  EXPECT_EQ(names.count("unknown"), 0U);
  // A peer may send a number that is no mode.
  EXPECT_EQ(to_string(static_cast<RobotMode>(200)), "unknown");
}

}  // namespace
}  // namespace swarm
