// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/gate/content_checks.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "swarm_core/metrics/histogram.hpp"
#include "swarm_link/to_message.hpp"
#include "swarm_link/wire_bounds.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::link {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
const UtcTime kNow{std::chrono::seconds(1'700'000'000)};

WireLimits limits() {
  return {.robots = 100,
          .bounds_m = {.min_m = {0.0, 0.0}, .max_m = {50.0, 40.0}},
          .bounds_slack_m = 5.0,
          .speed_max_mps = 1.5,
          .clock_skew_warn = std::chrono::milliseconds(250),
          .clock_skew_refuse = std::chrono::seconds(10)};
}

// One source that splits into two sinks.
PlanMessage good_plan() {
  PlanMessage plan{.version = 3, .epoch = 9, .t0_utc_ns = 5};
  plan.nodes = {{10, 10, 1.0, 0.2, 2.0, 0.0, 1.0},
                {20, 10, 1.0, 0.0, 1.0, 5.0, 0.25},
                {30, 10, 1.0, 0.0, 1.0, 7.5, 0.75}};
  plan.legs = {{0, 1, 0.25}, {0, 2, 0.75}};
  return plan;
}

RobotStateMessage good_state() {
  return {.robot_id = 99,
          .sequence_number = 1,
          .stamp_utc_ns = kNow.time_since_epoch().count(),
          .x_m = 10.0,
          .y_m = 20.0,
          .vx_mps = 1.0,
          .vy_mps = -1.0,
          .mode = RobotMode::kMoving};
}

StatusMessage good_status() {
  return {.robots = {{.robot_id = 1, .x_m = 1.0, .y_m = 2.0}},
          .refused = {1, 2},
          .state_age = {{3, 4}}};
}

template <class T>
testing::AssertionResult refused(const Checked<T>& verdict, RefusalReason reason) {
  if (verdict) return testing::AssertionFailure() << "accepted";
  if (verdict.error() == reason) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "refused as " << to_string(verdict.error());
}

// Applies a change to a valid message.
template <class M, class Change>
M changed(M message, Change change) {
  change(message);
  return message;
}

TEST(PlanCheck, AcceptsAFlowAndKeepsEveryNumber) {
  const auto plan = check_plan(good_plan(), limits());

  ASSERT_TRUE(plan);
  EXPECT_EQ(to_message(*plan, PlannerEpoch(9), PlanVersion(3), UtcTime(Duration(5))), good_plan());
}

TEST(PlanCheck, RefusesUnknownSchemas) {
  const auto plan = changed(good_plan(), [](auto& p) { p.schema_version = 1; });
  EXPECT_TRUE(refused(check_plan(plan, limits()), RefusalReason::kSchema));
}

TEST(PlanCheck, RefusesMoreElementsThanTheContractAllows) {
  const auto nodes = changed(good_plan(), [](auto& p) { p.nodes.resize(kMaxPlanNodes + 1); });
  const auto legs = changed(good_plan(), [](auto& p) { p.legs.resize(kMaxPlanLegs + 1); });
  EXPECT_TRUE(refused(check_plan(nodes, limits()), RefusalReason::kOversized));
  EXPECT_TRUE(refused(check_plan(legs, limits()), RefusalReason::kOversized));
}

TEST(PlanCheck, RefusesWhatIsNotFiniteInAnyField) {
  using Node = PlanNodeMessage;
  for (auto field :
       {&Node::mean_x_m, &Node::mean_y_m, &Node::covariance_xx_m2, &Node::covariance_xy_m2,
        &Node::covariance_yy_m2, &Node::time_s, &Node::mass}) {
    for (const double bad : {kNaN, kInfinity, -kInfinity}) {
      const auto plan = changed(good_plan(), [&](auto& p) { p.nodes[1].*field = bad; });
      EXPECT_TRUE(refused(check_plan(plan, limits()), RefusalReason::kNotFinite));
    }
  }
  const auto plan = changed(good_plan(), [](auto& p) { p.legs[0].mass = kNaN; });
  EXPECT_TRUE(refused(check_plan(plan, limits()), RefusalReason::kNotFinite));
}

TEST(PlanCheck, RefusesMeansTimesAndIndicesOutOfRange) {
  const auto bad = [](auto change) {
    return refused(check_plan(changed(good_plan(), change), limits()), RefusalReason::kOutOfRange);
  };
  EXPECT_TRUE(bad([](auto& p) { p.nodes[2].mean_x_m = 55.1; }));
  EXPECT_TRUE(bad([](auto& p) { p.nodes[2].mean_y_m = -5.1; }));
  EXPECT_TRUE(bad([](auto& p) { p.nodes[0].time_s = -0.1; }));
  EXPECT_TRUE(bad([](auto& p) { p.nodes[2].time_s = 1.1e6; }));
  EXPECT_TRUE(bad([](auto& p) { p.legs[0].from_node = 3; }));
  EXPECT_TRUE(bad([](auto& p) { p.legs[0].to_node = 0xFFFF'FFFF; }));
  EXPECT_TRUE(bad([](auto& p) { p.legs[0].to_node = 0; }));    // from a node to itself
  EXPECT_TRUE(bad([](auto& p) { p.nodes[1].time_s = 0.0; }));  // not forward in time
  EXPECT_TRUE(
      check_plan(changed(good_plan(), [](auto& p) { p.nodes[2].mean_x_m = 54.9; }), limits()));
}

TEST(PlanCheck, RefusesCovariancesThatAreNotPositiveDefinite) {
  const auto bad = [](double xx, double xy, double yy) {
    const auto plan = changed(good_plan(), [&](auto& p) {
      p.nodes[1].covariance_xx_m2 = xx;
      p.nodes[1].covariance_xy_m2 = xy;
      p.nodes[1].covariance_yy_m2 = yy;
    });
    return refused(check_plan(plan, limits()), RefusalReason::kBadGaussian);
  };
  EXPECT_TRUE(bad(-1.0, 0.0, 1.0));
  EXPECT_TRUE(bad(1.0, 0.0, 0.0));
  EXPECT_TRUE(bad(1.0, 1.0, 1.0));
  EXPECT_TRUE(bad(1e6, 0.0, 0.9e-4)) << "a needle: no transport map is exact";
  EXPECT_TRUE(bad(1.0, -2.0, 1.0));
  EXPECT_TRUE(bad(1e300, 0.0, 1.0));
}

TEST(PlanCheck, RefusesMassesThatAreNotAFlow) {
  const auto bad = [](auto change) {
    return refused(check_plan(changed(good_plan(), change), limits()), RefusalReason::kBadMass);
  };
  EXPECT_TRUE(bad([](auto& p) { p.nodes[0].mass = -1.0; }));
  EXPECT_TRUE(bad([](auto& p) { p.nodes[0].mass = 0.0; }));
  EXPECT_TRUE(bad([](auto& p) { p.legs[0].mass = 2.0; }));
  EXPECT_TRUE(bad([](auto& p) { p.legs[0].mass = 0.3; }));   // more than arrives
  EXPECT_TRUE(bad([](auto& p) { p.nodes[2].mass = 0.8; }));  // sinks do not sum to 1
  EXPECT_TRUE(bad([](auto& p) { p.legs.clear(); }));
  EXPECT_TRUE(bad([](auto& p) { p = PlanMessage{}; }));
}

TEST(PlanCheck, SurvivesAnyNumbers) {
  Rng rng(4);
  const double extremes[] = {0.0,  -0.0,      1.0,        -1.0, 1e-308, 1e308, -1e308,
                             kNaN, kInfinity, -kInfinity, 0.5,  1e-3,   1e5,   20.0};
  const auto any = [&] { return extremes[rng() % std::size(extremes)]; };
  for (int i = 0; i < 20'000; ++i) {
    PlanMessage plan;
    plan.nodes.resize(rng() % 5);
    for (auto& node : plan.nodes) node = {any(), any(), any(), any(), any(), any(), any()};
    plan.legs.resize(rng() % 5);
    for (auto& leg : plan.legs) {
      leg = {static_cast<std::uint32_t>(rng() % 6), static_cast<std::uint32_t>(rng() % 6), any()};
    }
    const auto verdict = check_plan(plan, limits());
    EXPECT_TRUE(!verdict || !verdict->empty());
  }
}

TEST(HeartbeatCheck, RefusesSchemaNumberAndPhase) {
  const HeartbeatMessage good{.phase = MissionPhase::kStopped, .mission_time_s = -3.0};
  EXPECT_TRUE(check_heartbeat(good));
  EXPECT_TRUE(refused(check_heartbeat(changed(good, [](auto& m) { m.schema_version = 0; })),
                      RefusalReason::kSchema));
  EXPECT_TRUE(refused(check_heartbeat(changed(good, [](auto& m) { m.mission_time_s = kNaN; })),
                      RefusalReason::kNotFinite));
  EXPECT_TRUE(refused(
      check_heartbeat(changed(good, [](auto& m) { m.phase = static_cast<MissionPhase>(4); })),
      RefusalReason::kOutOfRange));
  for (const double plan_time_s : {-0.1, 1.1e6, 1e300}) {
    EXPECT_TRUE(
        refused(check_heartbeat(changed(good, [&](auto& m) { m.plan_time_s = plan_time_s; })),
                RefusalReason::kOutOfRange));
  }
}

TEST(CommandCheck, RefusesSchemaAndKind) {
  const CommandMessage good{.kind = CommandKind::kStop};
  EXPECT_TRUE(check_command(good));
  EXPECT_TRUE(refused(check_command(changed(good, [](auto& m) { m.schema_version = 7; })),
                      RefusalReason::kSchema));
  EXPECT_TRUE(
      refused(check_command(changed(good, [](auto& m) { m.kind = static_cast<CommandKind>(4); })),
              RefusalReason::kOutOfRange));
}

TEST(StatusCheck, RefusesEachKindOfNonsense) {
  const auto verdict = [](auto change) {
    return check_status(changed(good_status(), change), limits());
  };
  EXPECT_TRUE(verdict([](auto&) {}));
  EXPECT_TRUE(refused(verdict([](auto& m) { m.schema_version = 1; }), RefusalReason::kSchema));
  EXPECT_TRUE(refused(verdict([](auto& m) { m.robots.resize(101); }), RefusalReason::kOversized));
  EXPECT_TRUE(refused(verdict([](auto& m) { m.refused.resize(17); }), RefusalReason::kOversized));
  EXPECT_TRUE(
      refused(verdict([](auto& m) { m.state_age.resize(465); }), RefusalReason::kOversized));
  EXPECT_TRUE(refused(verdict([](auto& m) { m.robots[0].x_m = kNaN; }), RefusalReason::kNotFinite));
  EXPECT_TRUE(refused(verdict([](auto& m) { m.robots[0].remaining_m = kInfinity; }),
                      RefusalReason::kNotFinite));
  EXPECT_TRUE(
      refused(verdict([](auto& m) { m.robots[0].robot_id = 100; }), RefusalReason::kOutOfRange));
  EXPECT_TRUE(
      refused(verdict([](auto& m) { m.first_robot_id = 100; }), RefusalReason::kOutOfRange));
  EXPECT_TRUE(
      refused(verdict([](auto& m) { m.robots[0].y_m = 46.0; }), RefusalReason::kOutOfRange));
  EXPECT_TRUE(refused(verdict([](auto& m) { m.robots[0].mode = static_cast<RobotMode>(5); }),
                      RefusalReason::kOutOfRange));
  EXPECT_TRUE(refused(verdict([](auto& m) { m.plan_time_s = 1e300; }), RefusalReason::kOutOfRange));
  EXPECT_TRUE(refused(verdict([](auto& m) { m.state_age[0].bin = Histogram::kBins; }),
                      RefusalReason::kOutOfRange));
}

TEST(EventCheck, RefusesLongTextsAndControlCharacters) {
  const EventMessage good{.severity = Severity::kError, .code = "plan-refused", .text = "Größe 3"};
  const auto verdict = [&](auto change) { return check_event(changed(good, change), limits()); };
  EXPECT_TRUE(verdict([](auto&) {}));
  EXPECT_TRUE(refused(verdict([](auto& m) { m.schema_version = 1; }), RefusalReason::kSchema));
  EXPECT_TRUE(refused(verdict([](auto& m) { m.code.assign(65, 'a'); }), RefusalReason::kOversized));
  EXPECT_TRUE(
      refused(verdict([](auto& m) { m.text.assign(513, 'a'); }), RefusalReason::kOversized));
  EXPECT_TRUE(refused(verdict([](auto& m) { m.text = "\x1b[2J"; }), RefusalReason::kOutOfRange));
  EXPECT_TRUE(refused(verdict([](auto& m) { m.severity = static_cast<Severity>(3); }),
                      RefusalReason::kOutOfRange));
}

// In UTF-8 a terminal also obeys C1 controls, and some code points reorder the text around them.
TEST(EventCheck, RefusesControlsBeyondAscii) {
  const auto check = [](const std::string& text) {
    return check_event({.source = 0, .code = "note", .text = text}, limits());
  };
  for (const char* text : {"a\xC2\x9B"
                           "31m",
                           "\xC2\x80", "\xC2\x9F",
                           "\xE2\x80\xAE"
                           "gpj.exe",
                           "\xE2\x80\xAA", "\xE2\x81\xA6", "\xE2\x81\xA9", "\xE2\x80\x8F",
                           "\x9B"
                           "31m",
                           "\xC0\x9B", "\xD8\x9C"}) {
    EXPECT_TRUE(refused(check(text), RefusalReason::kOutOfRange)) << text;
  }
  for (const char* text :
       {"\xC2\xA0", "10 \xC2\xB5m", "\xE2\x80\x93", "\xE2\x81\xB0", "\xE2\x86\x92"}) {
    EXPECT_TRUE(check(text)) << text;
  }
}

TEST(EventCheck, RefusesSourcesThatAreNoneOfTheMission) {
  const auto from = [](std::uint32_t source) {
    return check_event({.source = source, .code = "exit"}, limits());
  };
  for (const std::uint32_t source : {0U, 99U, kPlannerSource, kLauncherSource}) {
    EXPECT_TRUE(from(source)) << source;
  }
  EXPECT_TRUE(refused(from(100), RefusalReason::kOutOfRange));
  EXPECT_TRUE(refused(from(kLauncherSource - 1), RefusalReason::kOutOfRange));
}

TEST(BatchCheck, RefusesSchemaAndSize) {
  const CellStatesMessage good{.states = std::vector<RobotStateMessage>(kMaxCellStates)};
  EXPECT_TRUE(check_batch(good));
  EXPECT_TRUE(refused(check_batch(changed(good, [](auto& m) { m.schema_version = 1; })),
                      RefusalReason::kSchema));
  EXPECT_TRUE(refused(check_batch(changed(good, [](auto& m) { m.states.emplace_back(); })),
                      RefusalReason::kOversized));
}

TEST(StateCheck, RefusesEachKindOfNonsense) {
  const auto verdict = [](auto change) {
    return check_state(changed(good_state(), change), limits(), kNow);
  };
  EXPECT_TRUE(verdict([](auto&) {}));
  EXPECT_TRUE(refused(verdict([](auto& s) { s.x_m = kNaN; }), RefusalReason::kNotFinite));
  EXPECT_TRUE(refused(verdict([](auto& s) { s.vy_mps = kInfinity; }), RefusalReason::kNotFinite));
  EXPECT_TRUE(refused(verdict([](auto& s) { s.robot_id = 100; }), RefusalReason::kOutOfRange));
  EXPECT_TRUE(refused(verdict([](auto& s) { s.x_m = -5.1; }), RefusalReason::kOutOfRange));
  EXPECT_TRUE(refused(verdict([](auto& s) { s.vx_mps = 3.0; }), RefusalReason::kOutOfRange));
  EXPECT_TRUE(refused(verdict([](auto& s) { s.mode = static_cast<RobotMode>(255); }),
                      RefusalReason::kOutOfRange));
}

TEST(StateCheck, RefusesStampsFarFromOurClockEitherWay) {
  const auto verdict = [](std::int64_t stamp_utc_ns) {
    return check_state(changed(good_state(), [&](auto& s) { s.stamp_utc_ns = stamp_utc_ns; }),
                       limits(), kNow);
  };
  const auto now_ns = kNow.time_since_epoch().count();
  const std::int64_t refuse_ns = 10'000'000'000;
  EXPECT_TRUE(verdict(now_ns + refuse_ns));
  EXPECT_TRUE(verdict(now_ns - refuse_ns));
  for (const auto stamp :
       {now_ns + refuse_ns + 1, now_ns - refuse_ns - 1, std::int64_t{0},
        std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()}) {
    EXPECT_TRUE(refused(verdict(stamp), RefusalReason::kClockSkew));
  }
}

TEST(CheckPlan, RefusesEntriesAtSourcesThatAreNone) {
  const auto entered = [](std::uint16_t source, std::size_t robots) {
    auto plan = good_plan();
    plan.entries.assign(robots, {source, 7});
    return check_plan(plan, limits());
  };
  EXPECT_TRUE(entered(0, 100).has_value());
  EXPECT_TRUE(entered(kAnySource, 100).has_value());
  EXPECT_TRUE(refused(entered(1, 100), RefusalReason::kOutOfRange));
  EXPECT_TRUE(refused(entered(0, 101), RefusalReason::kOutOfRange));
  EXPECT_TRUE(refused(entered(0, kMaxPlanRobots + 1), RefusalReason::kOversized));
}

/// A scene with a moving circle, a triangle, the body of robot 42 and a new goal.
SceneMessage good_scene() {
  SceneMessage scene{.version = 5, .risk_alpha = 0.2, .next_id = 9, .removed = {1}};
  scene.obstacles = {
      {.obstacle_id = 3,
       .center = {4, 5},
       .radius_m = 1,
       .velocity_x_mps = 0.5,
       .moving_from_utc_ns = 100,
       .moving_until_utc_ns = 200},
      {.obstacle_id = 8, .vertices = 3},
      {.obstacle_id = 0x8000'0000 + 42, .owner_robot_id = 42, .center = {7, 7}, .radius_m = 0.2}};
  scene.vertices = {{1, 1}, {3, 1}, {2, 4}};
  scene.goal = {{10, 10, 1.0, 0.2, 2.0, 0.4}, {20, 10, 1.0, 0.0, 1.0, 0.6}};
  return scene;
}

TEST(CheckScene, AcceptsValidScenesAndReturnsThemUnchanged) {
  const auto scene = check_scene(good_scene(), limits());

  ASSERT_TRUE(scene.has_value());
  EXPECT_EQ(scene->obstacles[2].owner, RobotId(42));
  EXPECT_EQ(to_message(*scene), good_scene());
  EXPECT_TRUE(check_scene(to_message(first_scene(4)), limits()).has_value());
}

TEST(CheckScene, RefusesEveryField) {
  const auto verdict = [](auto change) {
    return check_scene(changed(good_scene(), change), limits());
  };
  EXPECT_TRUE(refused(verdict([](auto& s) { s.schema_version = 1; }), RefusalReason::kSchema));
  EXPECT_TRUE(refused(verdict([](auto& s) {
                        s.obstacles[0].moving_from_utc_ns =
                            std::numeric_limits<std::int64_t>::min();
                      }),
                      RefusalReason::kOutOfRange));
  EXPECT_TRUE(refused(verdict([](auto& s) {
                        s.obstacles[0].moving_until_utc_ns =
                            std::numeric_limits<std::int64_t>::max();
                      }),
                      RefusalReason::kOutOfRange));
  EXPECT_TRUE(refused(verdict([](auto& s) { s.removed.resize(kMaxSceneRemoved + 1); }),
                      RefusalReason::kOversized));
  EXPECT_TRUE(refused(verdict([](auto& s) { s.vertices.resize(kMaxSceneVertices + 1); }),
                      RefusalReason::kOversized));
  const auto out_of_range = [&](auto change) {
    return refused(verdict(change), RefusalReason::kOutOfRange);
  };
  for (const double bad : {kNaN, kInfinity, -kInfinity, 1e9}) {
    EXPECT_TRUE(out_of_range([&](auto& s) { s.obstacles[0].center.x_m = bad; }));
    EXPECT_TRUE(out_of_range([&](auto& s) { s.obstacles[0].center.y_m = bad; }));
    EXPECT_TRUE(out_of_range([&](auto& s) { s.obstacles[0].radius_m = bad; }));
    EXPECT_TRUE(out_of_range([&](auto& s) { s.obstacles[0].velocity_x_mps = bad; }));
    EXPECT_TRUE(out_of_range([&](auto& s) { s.obstacles[1].velocity_y_mps = bad; }));
    EXPECT_TRUE(out_of_range([&](auto& s) { s.vertices[1].x_m = bad; }));
    EXPECT_TRUE(out_of_range([&](auto& s) { s.goal[0].mean_x_m = bad; }));
    EXPECT_TRUE(out_of_range([&](auto& s) { s.risk_alpha = bad; }));
  }
  EXPECT_TRUE(out_of_range([](auto& s) { s.obstacles[0].radius_m = 0; }));
  EXPECT_TRUE(out_of_range([](auto& s) { s.obstacles[0].moving_from_utc_ns = 201; }));
  EXPECT_TRUE(out_of_range([](auto& s) { s.obstacles[0].obstacle_id = 8; }));  // not ascending
  EXPECT_TRUE(out_of_range([](auto& s) { s.obstacles[1].obstacle_id = 9; }));  // not assigned yet
  EXPECT_TRUE(out_of_range([](auto& s) { s.obstacles[1].vertices = 4; }));     // has only three
  EXPECT_TRUE(out_of_range([](auto& s) { s.vertices.push_back({9, 9}); }));    // not used
  EXPECT_TRUE(out_of_range([](auto& s) { s.vertices[2] = {2, 1}; }));          // no area
  EXPECT_TRUE(out_of_range([](auto& s) { s.next_id = 0x8000'0001; }));         // bodies' numbers
  EXPECT_TRUE(out_of_range([](auto& s) { s.obstacles[2].owner_robot_id = 100; }));  // no such robot
  EXPECT_TRUE(out_of_range([](auto& s) { s.obstacles[2].owner_robot_id = 43; }));   // another's
  EXPECT_TRUE(out_of_range([](auto& s) { s.obstacles[2].owner_robot_id = kNoRobot; }));
  EXPECT_TRUE(out_of_range([](auto& s) { s.obstacles[2].velocity_x_mps = 1; }));
  EXPECT_TRUE(refused(verdict([](auto& s) { s.goal[0].covariance_xx_m2 = -1; }),
                      RefusalReason::kBadGaussian));
  EXPECT_TRUE(refused(verdict([](auto& s) { s.goal[0].weight = 0.7; }), RefusalReason::kBadMass));
}

}  // namespace
}  // namespace swarm::link
