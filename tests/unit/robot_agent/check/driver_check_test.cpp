// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The check of drivers passes the built-in ones, and names the clause that a wrong driver breaks.
#include "robot_agent/check/driver_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "robot_agent/drivers/simulated_robot.hpp"
#include "swarmflow/mission/body_limits.hpp"
#include "swarmflow/robot/driver_registry.hpp"

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Verdict = ClauseResult::Verdict;

/// Passes at once; a driver that waits moves it on.
struct FakeClock final : CheckClock {
  SteadyTime now() override { return time; }
  void sleep_until(SteadyTime until) override { time = std::max(time, until); }
  SteadyTime time{seconds(1000)};
};

/// What is wrong with a driver.
enum class Wrong {
  kNothing,
  kRefusesToStart,
  kStartsOnce,
  kNeverHasAPosition,
  kNotFinite,
  kCreeps,
  kBodyFrame,
  kNorthEastDown,
  kMillimetres,
  kNoWatchdog,
  kWatchdogOfCalls,
  kIgnoresStop,
  kStopIsFinal,
  kKeepsALostPosition,
  kHealthWithoutText,
  kBlocks,
  kNegativeAge,
  kNeverLands,
  kNeverTakesOff,
  kStaysArmed,
  kTenfold,
};

/// A simulated body, seen and commanded through a fault. It flies if the test wants it to.
class WrongDriver final : public Driver {
 public:
  WrongDriver(Wrong wrong, FakeClock& clock, int starts, const bool& is_cut, bool flies,
              Vec2* end_m = nullptr)
      : wrong_(wrong),
        clock_(clock),
        starts_(starts),
        is_cut_(is_cut),
        flies_(flies),
        end_m_(end_m),
        body_(clock.time, Vec2(3, 4)) {}

  Result<void> start() override {
    if (wrong_ == Wrong::kRefusesToStart || (wrong_ == Wrong::kStartsOnce && starts_ > 1)) {
      return fail(ErrorCode::kBadInput, "no such port");
    }
    return {};
  }
  BodyAbilities abilities() const override {
    return {.flies = flies_, .stops_within = milliseconds(100)};
  }
  Measurement measure(SteadyTime now) override {
    if (wrong_ == Wrong::kBlocks) clock_.time += milliseconds(60);
    if (wrong_ == Wrong::kNoWatchdog) body_.command(now, last_, seconds(10));
    Measurement m = body_.measure(now);
    // It counts calls instead of time.
    if (wrong_ == Wrong::kWatchdogOfCalls && ++calls_ > 2) last_ = Vec2::Zero();
    if (wrong_ == Wrong::kWatchdogOfCalls) body_.command(now, last_, seconds(10));
    if (wrong_ == Wrong::kCreeps) creep_ += Vec2(0.01, 0);
    m.position_m += creep_;
    m.true_position_m.reset();
    if (wrong_ == Wrong::kNotFinite) m.position_m.x() = std::numeric_limits<double>::quiet_NaN();
    if (wrong_ == Wrong::kNeverHasAPosition) m.is_valid = false;
    if (wrong_ == Wrong::kNegativeAge) m.age = -seconds(1);
    if (is_cut_ && wrong_ != Wrong::kKeepsALostPosition) m.age = lost_ += milliseconds(100);
    if (!is_cut_) lost_ = {};
    return m;
  }
  void command(SteadyTime now, const Vec2& u, Duration valid_for) override {
    calls_ = 0;
    if (is_final_ || (flies_ && !is_flying_)) return;
    last_ = u;
    if (wrong_ == Wrong::kBodyFrame) last_ = Vec2(u.y(), -u.x());
    if (wrong_ == Wrong::kNorthEastDown) last_ = Vec2(u.y(), u.x());
    if (wrong_ == Wrong::kMillimetres) last_ = u / 1000.0;
    if (wrong_ == Wrong::kTenfold) last_ = 10.0 * u;
    body_.command(now, last_, valid_for);
  }
  void stop(SteadyTime now, StopKind kind) override {
    if (wrong_ == Wrong::kIgnoresStop) return body_.command(now, last_, milliseconds(200));
    calls_ = 0;
    last_ = Vec2::Zero();
    body_.command(now, last_, seconds(1));
    if (kind == StopKind::kLand && wrong_ != Wrong::kNeverLands) is_flying_ = false;
    if (kind == StopKind::kKill && wrong_ != Wrong::kStaysArmed) is_armed_ = false;
    is_final_ = is_final_ || wrong_ == Wrong::kStopIsFinal;
  }
  Result<void> begin(Manoeuvre what) override {
    if (what == Manoeuvre::kArm) is_armed_ = true;
    if (what == Manoeuvre::kTakeOff && wrong_ != Wrong::kNeverTakesOff) is_flying_ = true;
    return {};
  }
  void shutdown() override {
    if (end_m_ != nullptr) *end_m_ = *body_.measure(clock_.time).true_position_m;
  }
  DriverHealth health() const override {
    DriverHealth health;
    if (wrong_ == Wrong::kHealthWithoutText) health.level = DriverHealth::Level::kDegraded;
    health.is_armed = is_armed_;
    if (flies_) health.is_flying = is_flying_;
    return health;
  }

 private:
  Wrong wrong_;
  FakeClock& clock_;
  int starts_;
  const bool& is_cut_;
  bool flies_;
  Vec2* end_m_;  ///< where it was when its driver was shut down
  SimulatedRobot body_;
  Vec2 last_ = Vec2::Zero();
  Vec2 creep_ = Vec2::Zero();
  Duration lost_{};
  int calls_ = 0;
  bool is_final_ = false;
  bool is_armed_ = false;
  bool is_flying_ = false;
};

std::map<std::string, Verdict> verdicts(const std::vector<ClauseResult>& results) {
  std::map<std::string, Verdict> verdicts;
  for (const ClauseResult& r : results) verdicts[std::string(r.clause)] = r.verdict;
  return verdicts;
}

std::vector<ClauseResult> check(Wrong wrong, bool flies = false) {
  FakeClock clock;
  bool is_cut = false;
  int starts = 0;
  DriverCheckOptions options;
  options.may_kill = true;
  options.cut_pose = [&](bool cut) {
    is_cut = cut;
    return true;
  };
  return check_driver(
      [&]() -> Result<std::unique_ptr<Driver>> {
        return std::make_unique<WrongDriver>(wrong, clock, ++starts, is_cut, flies);
      },
      options, clock);
}

std::string text_of(const std::vector<ClauseResult>& results) {
  std::string text;
  for (const ClauseResult& r : results) text += std::string(r.clause) + ": " + r.text + "\n";
  return text;
}

TEST(DriverCheck, PassesADriverThatKeepsTheContract) {
  for (const bool flies : {false, true}) {
    const auto results = check(Wrong::kNothing, flies);
    for (const ClauseResult& r : results) {
      EXPECT_EQ(r.verdict, Verdict::kKept) << r.clause << ": " << r.text;
    }
    EXPECT_EQ(verdicts(results).size(), flies ? 15U : 14U) << text_of(results);
  }
}

TEST(DriverCheck, StopsARobotThatLeavesItsRoomAndEndsThere) {
  FakeClock clock;
  const bool is_cut = false;
  Vec2 end_m = Vec2::Zero();
  const auto results = check_driver(
      [&]() -> Result<std::unique_ptr<Driver>> {
        return std::make_unique<WrongDriver>(Wrong::kTenfold, clock, 1, is_cut, false, &end_m);
      },
      {}, clock);
  EXPECT_EQ(verdicts(results)["room"], Verdict::kBroken) << text_of(results);
  EXPECT_EQ(verdicts(results).count("restart"), 0U);
  EXPECT_LT((end_m - Vec2(3, 4)).norm(), 2.0 + 0.6) << "two periods at 3 m/s further";
}

TEST(DriverCheck, EndsWhenTheOperatorWantsIt) {
  FakeClock clock;
  const bool is_cut = false;
  DriverCheckOptions options;
  options.must_end = [&] { return clock.time > SteadyTime(seconds(1004)); };
  Vec2 end_m = Vec2::Zero();
  const auto results = check_driver(
      [&]() -> Result<std::unique_ptr<Driver>> {
        return std::make_unique<WrongDriver>(Wrong::kNothing, clock, 1, is_cut, false, &end_m);
      },
      options, clock);
  EXPECT_EQ(verdicts(results)["room"], Verdict::kNotTried) << text_of(results);
  EXPECT_LT(clock.time, SteadyTime(seconds(1010)));
}

TEST(DriverCheck, DoesNotBlameTheDriverForAPoseThatCannotBeCut) {
  FakeClock clock;
  const bool is_cut = false;
  DriverCheckOptions options;
  options.cut_pose = [](bool) { return false; };
  const auto results = check_driver(
      [&]() -> Result<std::unique_ptr<Driver>> {
        return std::make_unique<WrongDriver>(Wrong::kNothing, clock, 1, is_cut, false);
      },
      options, clock);
  EXPECT_EQ(verdicts(results)["lost-pose"], Verdict::kNotTried) << text_of(results);
}

TEST(DriverCheck, PassesTheBuiltInBodies) {
  for (const char* model : {"single_integrator", "double_integrator", "unicycle"}) {
    DriverRegistry registry;
    register_builtin_drivers(registry);
    const DriverEntry* entry = registry.find(model);
    ASSERT_NE(entry, nullptr);
    Mission mission;
    mission.robots.model = model;
    mission.robots.lag_s = declared_lag_s(mission.robots, entry->spec.lag);
    FakeClock clock;
    const auto results = check_driver(
        [&] {
          return entry->make({.mission = mission,
                              .robot = RobotId(0),
                              .position_m = {1, 2},
                              .now = clock.time,
                              .seed = 3});
        },
        DriverCheckOptions::of(mission, RobotId(0)), clock);
    for (const ClauseResult& r : results) {
      EXPECT_NE(r.verdict, Verdict::kBroken) << model << ", " << r.clause << ": " << r.text;
    }
    EXPECT_EQ(verdicts(results)["frames"], Verdict::kKept);
  }
}

TEST(DriverCheck, NamesTheClauseThatADriverBreaks) {
  const std::map<Wrong, std::string> broken = {{Wrong::kRefusesToStart, "start"},
                                               {Wrong::kStartsOnce, "restart"},
                                               {Wrong::kNeverHasAPosition, "position"},
                                               {Wrong::kNotFinite, "position"},
                                               {Wrong::kCreeps, "rest"},
                                               {Wrong::kBodyFrame, "frames"},
                                               {Wrong::kNorthEastDown, "frames"},
                                               {Wrong::kMillimetres, "frames"},
                                               {Wrong::kNoWatchdog, "watchdog"},
                                               {Wrong::kWatchdogOfCalls, "frozen"},
                                               {Wrong::kTenfold, "room"},
                                               {Wrong::kIgnoresStop, "hold"},
                                               {Wrong::kStopIsFinal, "frames"},
                                               {Wrong::kKeepsALostPosition, "lost-pose"},
                                               {Wrong::kHealthWithoutText, "sense"},
                                               {Wrong::kBlocks, "blocking"},
                                               {Wrong::kNegativeAge, "sense"},
                                               {Wrong::kStaysArmed, "kill"}};
  for (const auto& [wrong, clause] : broken) {
    const auto results = check(wrong);
    EXPECT_EQ(verdicts(results)[clause], Verdict::kBroken) << clause << " is kept:\n"
                                                           << text_of(results);
  }
  EXPECT_EQ(verdicts(check(Wrong::kNeverTakesOff, true))["arm"], Verdict::kBroken);
  EXPECT_EQ(verdicts(check(Wrong::kNeverLands, true))["land"], Verdict::kBroken);
}

}  // namespace
}  // namespace swarm::agent
