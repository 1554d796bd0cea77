// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
//
// Random scenes with silent, frozen, waking, cut-off, mute and adversarial robots, gaps in
// continuous time. Which contacts count: ContactOracle. SWARM_SCENES sets how many scenes,
// SWARM_SEED which (100000 take some minutes).
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"
#include "tests/unit/robot_agent/safety/silent_swarm.hpp"

namespace swarm::agent {
namespace {

constexpr int kFlight_ms = 14'000;
/// Room to retreat: against a wall no robot avoids one that drives on.
const Box kYard_m{{-14, -14}, {14, 14}};
constexpr double kApart_m = 2 * SilentSwarm::kRadius_m + 0.4;

int number(const char* variable, int otherwise) {
  const char* const text = std::getenv(variable);
  return text != nullptr ? std::atoi(text) : otherwise;
}
int scenes() { return number("SWARM_SCENES", 300); }
std::uint64_t seed(int scene) {
  return mix_seed(static_cast<std::uint64_t>(number("SWARM_SEED", 1)),
                  static_cast<std::uint64_t>(scene));
}

int random_ms(Rng& rng, double low_s, double high_s) {
  return 10 * static_cast<int>(100.0 * uniform(rng, low_s, high_s));
}
FaultSpan random_span(Rng& rng, double longest_s) {
  const int begin_ms = random_ms(rng, 0.5, 7.0);
  return {begin_ms, begin_ms + random_ms(rng, 0.1, longest_s)};
}

/// Nearly half of the robots fail.
void add_fault(Rng& rng, RobotPart& part) {
  const double kind = uniform01(rng);
  if (kind < 0.15) {
    part.frozen = random_span(rng, 8.0);
  } else if (kind < 0.25) {
    part.cut_off = random_span(rng, 8.0);
  } else if (kind < 0.35) {  // freezes while it is cut off, and wakes in or after it
    part.cut_off = random_span(rng, 8.0);
    part.frozen.begin_ms = part.cut_off.begin_ms + random_ms(rng, 0.0, 3.0);
    part.frozen.end_ms = part.frozen.begin_ms + random_ms(rng, 0.1, 8.0);
  } else if (kind < 0.45) {
    part.mute = random_span(rng, 8.0);
  }
}

/// Robots start in a square of twice `half_m`.
std::vector<RobotPart> random_group(int scene, double half_m = 6.0) {
  Rng rng(seed(scene));
  std::vector<RobotPart> parts;
  const std::size_t robots = 2 + rng() % 7;
  for (int tries = 0; tries < 80 && parts.size() < robots; ++tries) {
    const Vec2 start(uniform(rng, -half_m, half_m), uniform(rng, -half_m, half_m));
    const bool has_room = std::all_of(parts.begin(), parts.end(), [&](const RobotPart& p) {
      return (p.start_m - start).norm() > kApart_m;
    });
    if (!has_room) continue;
    RobotPart part{.start_m = start, .goal_m = -start};
    if (uniform01(rng) < 0.5) part.goal_m = {uniform(rng, -6.0, 6.0), uniform(rng, -6.0, 6.0)};
    part.phase_ms = 10 * static_cast<int>(rng() % 10);
    add_fault(rng, part);
    parts.push_back(part);
  }
  return parts;
}

SilentSwarm::Approach fly(const std::vector<RobotPart>& parts, SilenceRule rule,
                          Cells cells = Cells::kOne) {
  SilentSwarm swarm(kYard_m, parts, rule, cells);
  return swarm.fly_until(kFlight_ms);
}

std::string describe(const FaultSpan& span) {
  return fmt::format("{}-{}", span.begin_ms, span.end_ms);
}
/// For messages: who came near whom, and what was wrong with them.
std::string describe(int scene, const std::vector<RobotPart>& parts,
                     const SilentSwarm::Approach& nearest) {
  std::string text = fmt::format("scene {} at {} ms:", scene, nearest.at_ms);
  for (const std::size_t i : {nearest.first, nearest.second}) {
    text += fmt::format(" robot {} frozen {} cut off {} mute {};", i, describe(parts[i].frozen),
                        describe(parts[i].cut_off), describe(parts[i].mute));
  }
  return text;
}

TEST(SilenceScenes, NoContactsThatCount) {
  int others = 0;
  for (int scene = 0; scene < scenes(); ++scene) {
    const std::vector<RobotPart> parts = random_group(scene);
    const SilentSwarm::Approach nearest = fly(parts, SilenceRule::kKeep);
    EXPECT_FALSE(nearest.counts) << describe(scene, parts, nearest);
    others += nearest.gap_m <= 0.0 && !nearest.counts ? 1 : 0;
  }
  fmt::print("{} scenes, {} contacts that do not count\n", scenes(), others);
}

// The same scenes: without the rule they contain contacts, so the test above can fail.
TEST(SilenceScenes, ForgettingSilentRobotsCollides) {
  int contacts = 0;
  for (int scene = 0; scene < 300; ++scene) {
    contacts += fly(random_group(scene), SilenceRule::kForget).counts ? 1 : 0;
  }
  EXPECT_GT(contacts, 0);
}

// All contacts, those of robots that fell silent before they were received among them: to take a
// robot that left the cells for silent avoids hardly any.
TEST(SilenceScenes, ADiscForEachRobotThatLeftTheCellsAvoidsNoContacts) {
  int elsewhere = 0, silent = 0;
  for (int scene = 0; scene < scenes(); ++scene) {
    const std::vector<RobotPart> parts = random_group(scene, 9.0);
    elsewhere += fly(parts, SilenceRule::kKeep, Cells::kLeftIsElsewhere).gap_m <= 0.0 ? 1 : 0;
    silent += fly(parts, SilenceRule::kKeep, Cells::kLeftIsSilent).gap_m <= 0.0 ? 1 : 0;
  }
  fmt::print("{} scenes with cells: {} contacts, {} with a disc for each\n", scenes(), elsewhere,
             silent);
  EXPECT_LE(elsewhere, silent + 1 + scenes() / 1000);
}

// A robot that falls silent before another receives it is in the launcher's beats.
TEST(SilenceScenes, BeatsThatListLateRobotsAvoidContacts) {
  int listed = 0, not_listed = 0;
  for (int scene = 0; scene < scenes(); ++scene) {
    const std::vector<RobotPart> parts = random_group(scene, 9.0);
    const auto nearest = fly(parts, SilenceRule::kKeep, Cells::kLeftIsElsewhere);
    listed += nearest.gap_m <= 0.0 ? 1 : 0;
    not_listed += fly(parts, SilenceRule::kKeep, Cells::kNoLateRobots).gap_m <= 0.0 ? 1 : 0;
  }
  fmt::print("{} scenes with cells: {} contacts, {} without late robots in the beats\n", scenes(),
             listed, not_listed);
  EXPECT_LE(listed, not_listed);
}

TEST(SilenceScenes, AFrozenRobotIsPassedAndNotDrivenInto) {
  const std::vector<RobotPart> parts = {
      {.start_m = {-7, 0}, .goal_m = {7, 0}},
      {.start_m = {0, 0.05}, .goal_m = {0, 0.05}, .frozen = {300, kFlight_ms}}};
  SilentSwarm keeps({{-8, -8}, {8, 8}}, parts, SilenceRule::kKeep);
  EXPECT_GT(keeps.fly_until(2 * kFlight_ms).gap_m, 0.0);
}

/// A robot that drives into another one, which avoids it. No robot can avoid for ever one that is
/// not received and does not stand: it is mute for no longer than a robot that is cut off drives.
std::vector<RobotPart> random_pursuit(int scene) {
  Rng rng(seed(scene));
  const double angle = uniform(rng, 0, 2 * std::numbers::pi);
  std::vector<RobotPart> parts = {
      {.goal_m = {uniform(rng, -2, 2), uniform(rng, -2, 2)}},
      {.start_m = 5.0 * Vec2(std::cos(angle), std::sin(angle)), .rams = 0}};
  parts[1].phase_ms = 10 * static_cast<int>(rng() % 10);
  const double kind = uniform01(rng);
  if (kind < 0.3) {
    parts[1].frozen = random_span(rng, 8.0);
  } else if (kind < 0.5) {
    parts[1].cut_off = random_span(rng, 8.0);
  } else if (kind < 0.7) {
    parts[1].mute = random_span(rng, 2.0);
  }
  return parts;
}

TEST(SilenceScenes, ARobotThatRamsIsEvadedInTheOpenAlsoOnceItIsSilent) {
  int others = 0;
  for (int scene = 0; scene < scenes(); ++scene) {
    const std::vector<RobotPart> parts = random_pursuit(scene);
    SilentSwarm swarm({{-100, -100}, {100, 100}}, parts, SilenceRule::kKeep);
    const SilentSwarm::Approach nearest = swarm.fly_until(kFlight_ms);
    EXPECT_FALSE(nearest.counts) << describe(scene, parts, nearest);
    others += nearest.gap_m <= 0.0 && !nearest.counts ? 1 : 0;
  }
  fmt::print("{} pursuits, {} contacts that do not count\n", scenes(), others);
}

}  // namespace
}  // namespace swarm::agent
