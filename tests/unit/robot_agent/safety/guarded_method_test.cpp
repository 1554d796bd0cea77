// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/safety/guarded_method.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "robot_agent/safety/fault_text.hpp"

namespace swarm::agent {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// What a method does at the call that is to fail.
enum class Failure { kThrows, kThrowsAnInteger, kReturnsNan };

/// Fails at the call number `fails_at`, counted from 0 over all of its functions.
struct Script {
  Failure failure = Failure::kThrows;
  int fails_at = -1;  ///< −1: never
  std::string what = "out of fuel";
  int calls = 0;
};

class Scripted final : public ControlMethod {
 public:
  explicit Scripted(Script& script) : script_(&script) {}

  void set_goals(const FlowPlan&) override {
    had_goals_ = true;
    call();
  }
  void begin(const Route&, const World&) override {
    EXPECT_TRUE(had_goals_);  // a method may need the goals to begin a route
    call();
  }
  bool has_arrived(const ControlView&) override {
    call();
    return true;
  }
  Vec2 desired_velocity(const ControlView&, bool arrived, Rng&) override {
    return {arrived ? 0.25 : 1.0, call() ? kNan : 0.0};
  }
  Vec2 hold(const ControlView&) override { return {call() ? kNan : 0.125, 0.0}; }
  std::uint32_t goal(const Vec2&) const override {
    call();
    return 3;
  }
  std::optional<TimeTracking> tracking() const override {
    return TimeTracking{.plan_time_s = 7.0, .reference_m = {1.0, call() ? kNan : 2.0}};
  }
  double lag_s() const override { return call() ? kNan : 1.5; }
  double remaining_m() const override {
    return call() ? std::numeric_limits<double>::infinity() : 12.0;
  }
  std::uint32_t escapes() const override {
    call();
    return 2;
  }

 private:
  /// Whether this is the call whose result is to be wrong.
  bool call() const {
    if (script_->calls++ != script_->fails_at) return false;
    if (script_->failure == Failure::kThrows) throw std::runtime_error(script_->what);
    if (script_->failure == Failure::kThrowsAnInteger) throw 7;
    return true;
  }

  Script* script_;
  bool had_goals_ = false;
};

/// Everything that a round of calls returned.
struct Results {
  bool arrived = false;
  Vec2 desired_mps = Vec2::Zero();
  Vec2 hold_mps = Vec2::Zero();
  std::uint32_t goal = 0;
  std::optional<TimeTracking> tracking{};
  double lag_s = 0.0;
  double remaining_m = 0.0;
  std::uint32_t escapes = 0;
};

constexpr int kCallsInARound = 10;  // begin() makes two

/// Calls every function once, in the order of the control loop.
Results call_all(GuardedMethod& sut) {
  const World world;
  const ControlView view{.now = {}, .neighbours = {}, .world = world};
  Rng rng(1);
  sut.begin(FlowPlan(), Route(), world);
  Results r;
  r.arrived = sut.has_arrived(view);
  r.desired_mps = sut.desired_velocity(view, r.arrived, rng);
  r.hold_mps = sut.hold(view);
  r.goal = sut.goal({0, 0});
  r.tracking = sut.tracking();
  r.lag_s = sut.lag_s();
  r.remaining_m = sut.remaining_m();
  r.escapes = sut.escapes();
  return r;
}

/// The results of a robot that stays where it is.
void expect_at_rest(const Results& r) {
  EXPECT_FALSE(r.arrived);
  EXPECT_EQ(r.desired_mps, Vec2(0, 0));
  EXPECT_EQ(r.hold_mps, Vec2(0, 0));
  EXPECT_EQ(r.goal, 0U);
  EXPECT_FALSE(r.tracking.has_value());
  EXPECT_EQ(r.lag_s, 0.0);
  EXPECT_EQ(r.remaining_m, 0.0);
  EXPECT_EQ(r.escapes, 0U);
}

TEST(GuardedMethod, PassesEverythingOnWhileTheMethodWorks) {
  Script script;
  GuardedMethod sut(ControlSlot::of<Scripted>(script));

  for (int round = 1; round <= 3; ++round) {
    const Results r = call_all(sut);

    EXPECT_TRUE(r.arrived);
    EXPECT_EQ(r.desired_mps, Vec2(0.25, 0));
    EXPECT_EQ(r.hold_mps, Vec2(0.125, 0));
    EXPECT_EQ(r.goal, 3U);
    ASSERT_TRUE(r.tracking.has_value());
    EXPECT_EQ(r.tracking->reference_m, Vec2(1, 2));
    EXPECT_EQ(r.lag_s, 1.5);
    EXPECT_EQ(r.remaining_m, 12.0);
    EXPECT_EQ(r.escapes, 2U);
    EXPECT_EQ(script.calls, round * kCallsInARound);
  }
  EXPECT_EQ(sut.fault(), "");
}

TEST(GuardedMethod, EndsAnyExceptionAndNeverCallsTheMethodAgain) {
  for (int fails_at = 0; fails_at < kCallsInARound; ++fails_at) {
    for (const Failure failure : {Failure::kThrows, Failure::kThrowsAnInteger}) {
      Script script{.failure = failure, .fails_at = fails_at};
      GuardedMethod sut(ControlSlot::of<Scripted>(script));

      call_all(sut);
      expect_at_rest(call_all(sut));

      EXPECT_EQ(script.calls, fails_at + 1);
      EXPECT_EQ(sut.fault(), failure == Failure::kThrows
                                 ? "the control method threw: out of fuel"
                                 : "the control method threw what is no std::exception");
    }
  }
}

// One status message has the numbers of many robots, and receivers refuse it as a whole if one of
// them is not finite.
TEST(GuardedMethod, PassesNoNumberOnThatIsNotFinite) {
  const std::pair<int, const char*> cases[] = {
      {3, "velocity"}, {4, "velocity"}, {6, "reference"}, {7, "lag"}, {8, "remaining length"}};
  for (const auto& [fails_at, name] : cases) {
    Script script{.failure = Failure::kReturnsNan, .fails_at = fails_at};
    GuardedMethod sut(ControlSlot::of<Scripted>(script));

    const Results r = call_all(sut);

    EXPECT_TRUE(r.desired_mps.allFinite() && r.hold_mps.allFinite()) << name;
    EXPECT_TRUE(!r.tracking || r.tracking->reference_m.allFinite()) << name;
    EXPECT_TRUE(std::isfinite(r.lag_s) && std::isfinite(r.remaining_m)) << name;
    EXPECT_EQ(sut.fault(),
              std::string("the control method returned a ") + name + " that is not finite");
    expect_at_rest(call_all(sut));
    EXPECT_EQ(script.calls, fails_at + 1);
  }
}

// The first fault is the cause, and an event carries one line.
TEST(GuardedMethod, ReportsItsFaultInOneShortLine) {
  Script script{.fails_at = 0, .what = "line 1\nline 2\t\x1b[31m" + std::string(1000, 'x')};
  GuardedMethod sut(ControlSlot::of<Scripted>(script));

  call_all(sut);

  EXPECT_TRUE(sut.fault().starts_with("the control method threw: line 1 line 2  [31mxxx"));
  EXPECT_TRUE(sut.fault().ends_with("xxx..."));
  EXPECT_EQ(sut.fault().size(), kMaxFaultText);
}

TEST(FaultText, KeepsWhatFits) {
  EXPECT_EQ(fault_text(""), "");
  EXPECT_EQ(fault_text("battery at 4 % \xc2\xb1 1"), "battery at 4 % \xc2\xb1 1");
  EXPECT_EQ(fault_text(std::string(kMaxFaultText, 'a')), std::string(kMaxFaultText, 'a'));
  EXPECT_EQ(fault_text(std::string(kMaxFaultText + 1, 'a')).size(), kMaxFaultText);
}

}  // namespace
}  // namespace swarm::agent
