// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/neighbours/neighbour_table.hpp"

#include <map>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;

SteadyTime at(int ms) { return SteadyTime(milliseconds(ms)); }

NeighbourTable table() {
  return NeighbourTable(NeighbourOptions{.radius_m = 0.2,
                                         .fleet = Fleet(Fleet::Body{0.2, 1.5}),
                                         .communication_radius_m = 6.0,
                                         .near_m = 1.0,
                                         .period = milliseconds(100),
                                         .expected_silence = milliseconds(700),
                                         .forget_after = milliseconds(1000)});
}

NeighbourReport report(std::uint32_t robot, std::uint32_t sequence, int ms, Vec2 position,
                       Vec2 velocity = Vec2::Zero()) {
  return {RobotId(robot), sequence, at(ms), position, velocity};
}

TEST(NeighbourTable, ExtrapolatesAlongTheLastVelocity) {
  auto sut = table();
  sut.take(report(3, 1, 0, {2, 0}, {0.5, -1}), Vec2::Zero());

  const auto now = sut.at(at(400), Vec2::Zero()).all;

  ASSERT_EQ(now.size(), 1U);
  EXPECT_NEAR(now[0].position_m.x(), 2.2, 1e-6);
  EXPECT_NEAR(now[0].position_m.y(), -0.4, 1e-6);
  EXPECT_DOUBLE_EQ(now[0].radius_m, 0.2);
}

TEST(NeighbourTable, ReportsThePossibleStopAge) {
  auto sut = table();
  sut.take(report(3, 1, 0, {1, 0}, {1, 0}), Vec2::Zero());

  EXPECT_DOUBLE_EQ(sut.at(at(200), Vec2::Zero()).all[0].possible_stop_age_s,
                   0.0);  // its command still holds
  EXPECT_NEAR(sut.at(at(500), Vec2::Zero()).all[0].possible_stop_age_s, 0.3, 1e-12);
  EXPECT_NEAR(sut.at(at(500), Vec2::Zero()).all[0].position_m.x(), 1.5, 1e-12);
}

/// Receives robot 3, one metre away, ten times a second; `lost` messages after the first are lost.
void receive_at_every_tick(NeighbourTable& sut, int count, int lost) {
  static std::uint32_t sequence = 0;
  for (int i = 0; i < count; ++i) {
    ++sequence;
    if (i > 0 && i <= lost) continue;
    const int ms = 100 * static_cast<int>(sequence);
    sut.take(report(3, sequence, ms, {1, 0}, {1, 0}), Vec2::Zero());
    sut.at(at(ms), Vec2::Zero());
  }
}

TEST(NeighbourTable, RatesALinkDegradedWhileUpdatesAreMissing) {
  auto sut = table();

  receive_at_every_tick(sut, 20, 0);
  EXPECT_FALSE(sut.link().poor);
  receive_at_every_tick(sut, 10, 1);
  EXPECT_FALSE(sut.link().poor) << "one message may get lost";
  receive_at_every_tick(sut, 10, 3);
  EXPECT_TRUE(sut.link().poor);
  receive_at_every_tick(sut, 200, 0);
  EXPECT_FALSE(sut.link().poor);
}

TEST(NeighbourTable, DoesNotCountARobotThatWasOutOfRangeAsLostUpdates) {
  auto sut = table();
  for (std::uint32_t i = 0; i < 40; ++i) {
    sut.take(report(3, 4 * i, static_cast<int>(400 * i), {5.5, 0}), Vec2::Zero());
    sut.at(at(static_cast<int>(400 * i)), Vec2::Zero());
  }

  EXPECT_FALSE(sut.link().poor);
}

TEST(NeighbourTable, InformationAgeIsTheDelayAndOnADegradedLinkTheTimeSinceTheLastUpdate) {
  auto sut = table();
  NeighbourReport state = report(4, 1, 0, {1, 0.5}, {1, 0});
  sut.take(state, Vec2::Zero(), milliseconds(50));
  EXPECT_NEAR(sut.at(at(400), Vec2::Zero()).all[0].information_age_s, 0.05, 1e-6);

  receive_at_every_tick(sut, 20, 5);
  ASSERT_TRUE(sut.link().poor);
  state.sequence = 2;
  state.as_of = at(1000000);
  sut.take(state, Vec2::Zero(), milliseconds(50));
  const auto later = sut.at(at(1000400), Vec2::Zero()).all;
  ASSERT_EQ(later.size(), 1U);
  EXPECT_NEAR(later[0].information_age_s, 0.4, 1e-6);
}

TEST(NeighbourTable, GrowsTheRadiusOfARobotWithoutUpdates) {
  auto sut = table();
  sut.take(report(3, 1, 0, {1, 0}), Vec2::Zero());

  const auto now = sut.at(at(900), Vec2::Zero()).all;

  ASSERT_EQ(now.size(), 1U);
  EXPECT_NEAR(now[0].radius_m, 0.2 + 1.5 * 0.2, 1e-12);
}

TEST(NeighbourTable, ForgetsRobotsOlderThanTheHorizon) {
  auto sut = table();
  sut.take(report(3, 1, 0, {1, 0}), Vec2::Zero());

  EXPECT_TRUE(sut.at(at(1001), Vec2::Zero()).all.empty());
}

TEST(NeighbourTable, DropsRobotsThatLeaveTheCommunicationRadiusBetweenUpdates) {
  auto sut = table();
  sut.take(report(3, 1, 0, {5.9, 0}, {1, 0}), Vec2::Zero());
  sut.take(report(4, 1, 0, {5.9, 0}), Vec2::Zero());

  EXPECT_EQ(sut.at(at(200), Vec2::Zero()).all.size(), 1U);   // it left
  EXPECT_EQ(sut.at(at(200), Vec2(-0.2, 0)).all.size(), 0U);  // we left
  EXPECT_EQ(sut.at(at(200), Vec2::Zero()).all.size(), 0U);   // and must receive it again
}

TEST(NeighbourTable, RefusesOldAndRepeatedUpdates) {
  auto sut = table();
  sut.take(report(3, 5, 100, {1, 0}), Vec2::Zero());

  EXPECT_EQ(sut.take(report(3, 5, 100, {2, 0}), Vec2::Zero()), NeighbourTable::Outcome::kDuplicate);
  EXPECT_EQ(sut.take(report(3, 4, 200, {2, 0}), Vec2::Zero()), NeighbourTable::Outcome::kStale);
  EXPECT_EQ(sut.at(at(100), Vec2::Zero()).all[0].position_m.x(), 1.0);
}

TEST(NeighbourTable, AcceptsTheWrapOfTheSequence) {
  auto sut = table();
  sut.take(report(3, 0xFFFF'FFFF, 100, {1, 0}), Vec2::Zero());

  EXPECT_EQ(sut.take(report(3, 0, 200, {2, 0}), Vec2::Zero()), NeighbourTable::Outcome::kTaken);
}

TEST(NeighbourTable, LetsARestartedRobotStartOver) {
  auto sut = table();
  sut.take(report(3, 500, 0, {1, 0}), Vec2::Zero());

  EXPECT_EQ(sut.take(report(3, 1, 1500, {2, 0}), Vec2::Zero()), NeighbourTable::Outcome::kTaken);
}

// Longer than a robot may be silent, but not forgotten yet: a process restarts within a second.
TEST(NeighbourTable, LetsARobotStartOverThatWasSilentForLongerThanExpected) {
  auto sut = table();
  sut.take(report(3, 500, 0, {1, 0}), Vec2::Zero());

  EXPECT_EQ(sut.take(report(3, 1, 650, {2, 0}), Vec2::Zero()), NeighbourTable::Outcome::kStale);
  EXPECT_EQ(sut.take(report(3, 1, 750, {2, 0}), Vec2::Zero()), NeighbourTable::Outcome::kTaken);
}

TEST(NeighbourTable, PositionsAreExactToMicrometresFarAwayAndLateInAMission) {
  auto sut = table();
  const Vec2 far_m(40'000.123456, -70'000.654321);
  for (int s = 0; s < 400; ++s) {  // both go north at 2 m/s
    const Vec2 own_m = far_m + Vec2(0.0, 2.0 * s);
    const auto i = static_cast<std::uint32_t>(s);
    const Vec2 other_m = own_m + Vec2(1.25, 0.5);
    sut.take(report(3, i, 1000 * (s + 100'000), other_m, {0.0, 2.0}), own_m);

    const auto now = sut.at(at(1000 * (s + 100'000) + 300), own_m).all;

    ASSERT_EQ(now.size(), 1U);
    EXPECT_LT((now[0].position_m - (other_m + Vec2(0.0, 0.6))).norm(), 1e-5);
    EXPECT_NEAR(now[0].possible_stop_age_s, 0.1, 1e-9);
  }
}

/// The expected estimates, by a scan of all robots.
class Naive {
 public:
  void take(const NeighbourReport& r, const Vec2& own_m) {
    if ((r.position_m - own_m).norm() > 6.0) {
      known_.erase(r.robot.value());
    } else {
      known_[r.robot.value()] = r;
    }
  }
  std::map<std::uint32_t, Vec2> at(SteadyTime now, const Vec2& own_m) {
    std::map<std::uint32_t, Vec2> estimated;
    for (auto it = known_.begin(); it != known_.end();) {
      const double age_s = to_seconds(now - it->second.as_of);
      const Vec2 position_m = it->second.position_m + age_s * it->second.velocity_mps;
      if (age_s > 1.0 || (position_m - own_m).norm() > 6.0) {
        it = known_.erase(it);
      } else {
        estimated[it++->first] = position_m;
      }
    }
    return estimated;
  }

 private:
  std::map<std::uint32_t, NeighbourReport> known_;
};

TEST(NeighbourTable, EstimatesEqualAScanOfAllRobots) {
  Rng rng(7);
  auto sut = table();
  Naive naive;
  std::size_t estimated = 0;
  for (std::uint32_t tick = 0; tick < 3000; ++tick) {
    const Vec2 own_m(0.1 * tick, 0.0);
    for (int state = 0; state < 8; ++state) {
      const auto robot = static_cast<std::uint32_t>(rng() % 500);
      const Vec2 offset_m(uniform(rng, -8.0, 8.0), uniform(rng, -8.0, 8.0));
      const Vec2 velocity_mps(uniform(rng, -1.5, 1.5), uniform(rng, -1.5, 1.5));
      const NeighbourReport sent =
          report(robot, tick + 1, 100 * static_cast<int>(tick), own_m + offset_m, velocity_mps);
      if (sut.take(sent, own_m) != NeighbourTable::Outcome::kDuplicate) naive.take(sent, own_m);
    }

    const SteadyTime now = at(100 * static_cast<int>(tick) + 50);
    std::map<std::uint32_t, Vec2> expected = naive.at(now, own_m);

    for (const Neighbour& n : sut.at(now, own_m).all) {
      ASSERT_TRUE(expected.contains(n.robot.value()));
      EXPECT_LT((n.position_m - expected[n.robot.value()]).norm(), 1e-4);
      expected.erase(n.robot.value());
      ++estimated;
    }
    EXPECT_TRUE(expected.empty());
    EXPECT_EQ(sut.known(), naive.at(now, own_m).size());
  }
  EXPECT_GT(estimated, 10'000U);
}

TEST(NeighbourTable, ReportsCloseNeighboursFirst) {
  NeighbourTable sut(NeighbourOptions{.fleet = Fleet(Fleet::Body{0.2, 1.5}),
                                      .communication_radius_m = 6.0,
                                      .reach_m = 4.0,
                                      .close_m = 1.5,
                                      .reach_growth_mps = 2.0,
                                      .period = milliseconds(100),
                                      .expected_silence = milliseconds(700),
                                      .forget_after = milliseconds(1000)});
  for (std::uint32_t i = 0; i < 40; ++i) {  // 0.15 to 6 m away
    sut.take(report(i, 1, 0, {0.0, 0.15 * (40 - i)}), Vec2::Zero());
  }

  const Neighbourhood fresh = sut.at(at(100), Vec2::Zero());
  EXPECT_EQ(fresh.all.size(), 26U);
  ASSERT_EQ(fresh.close.size(), 10U);
  for (const Neighbour& n : fresh.close) EXPECT_LE(n.position_m.y(), 1.5);
  EXPECT_EQ(fresh.close.data(), fresh.all.data());

  // A robot silent for 0.2 s longer than expected may be 0.4 m nearer by now.
  const Neighbourhood old = sut.at(at(900), Vec2::Zero());
  EXPECT_EQ(old.all.size(), 29U);
  EXPECT_EQ(old.close.size(), 12U);
}

TEST(NeighbourTable, DropsRobotsThatLeaveTheNeighbourhood) {
  auto sut = table();
  sut.take(report(3, 1, 0, {1, 0}), Vec2::Zero());

  EXPECT_EQ(sut.take(report(3, 2, 10, {7, 0}), Vec2::Zero()), NeighbourTable::Outcome::kFar);
  EXPECT_TRUE(sut.at(at(10), Vec2::Zero()).all.empty());
}

}  // namespace
}  // namespace swarm::agent
