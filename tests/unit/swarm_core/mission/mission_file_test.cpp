// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/mission/mission_file.hpp"

#include <algorithm>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "swarm_core/risk/mixture_cvar.hpp"
#include "swarm_launcher/processes/builtin_catalogue.hpp"
#include "swarmflow/core/cvar.hpp"
#include "swarmflow/mission/section_key.hpp"
#include "tests/unit/swarm_core/mission/same_mission.hpp"

namespace swarm {
namespace {

/// Parses with the built-in components.
Result<Mission> parse(std::string_view yaml, const std::string& name) {
  return parse_mission(yaml, name, {}, builtin_catalogue());
}

constexpr const char* kLeast = R"(version: 1
world: {bounds_m: [0, 0, 20, 10]}
start: [{mean_m: [3, 5], covariance_m2: [[1, 0], [0, 1]], weight: 1}]
goal: [{mean_m: [17, 5], covariance_m2: [[1, 0], [0, 1]], weight: 1}]
)";

/// Every section with values that are not the defaults.
constexpr const char* kFull = R"(version: 1
name: full-1
world:
  bounds_m: [-1e1, 0, 20.5, 10]
  obstacles:
    - polygon_m: [[8, 2], [8, 3], [9, 3], [9, 2]]
    - circle_m: {center: [12, 6], radius: 0.75}
    - {polygon_m: [[5, 0], [7, 0], [7, 1], [6, 1], [6, 2], [5, 2]]}
robots:
  count: 7
  radius_m: 0.1
  speed_max_mps: 1
  placement_gap_m: 0.3
  groups:
    - {count: 2, model: unicycle, turn_rate_max_radps: 2, communication_radius_m: 6}
    - {count: 3, radius_m: 0.15, speed_max_mps: 0.8, position_noise_m: 0.05}
start:
  - {mean_m: [3, 5], covariance_m2: [[1, 0.1], [0.1, 1.5]], weight: 0.3}
  - {mean_m: [2, 8], covariance_m2: [[0.5, 0], [0, 0.5]], weight: 0.7}
goal: [{mean_m: [17, 5], covariance_m2: [[1, 0], [0, 1]], weight: 1}]
planner:
  method: swarmprm
  sampler: uniform
  density_cap: static
  density_cap_per_m2: 1.5
  samples: 77
  risk_alpha: 0.1
  sigma_min_m: 0.3
  speed_mps: 0.9
control: {method: crops, rate_hz: 20, cruise_mps: 0.95, look_ahead_s: 3.3}
safety: {gap_share: 0.5, follow_share: 0.1}
link: {cell_size_m: 12, send_error_m: 0.01}
timing: {heartbeat_hz: 10}
launcher: {quorum_share: 0.9, respawn_agent_max: 2}
criteria: {w2_ratio_max: 1.15, density_over_cap_max: -0.1, own_place_share_min: 0}
script:
  - {at_s: 5, action: pause}
  - {at_s: 5, action: add_obstacle, circle_m: {center: [8, 8], radius: 0.3}}
  - {at_s: 5.5, action: move_obstacle, obstacle: 3, by_m: [1, -2], over_s: 4}
  - {at_s: 6, action: remove_obstacle, obstacle: 0}
  - at_s: 6
    action: goto
    goal:
      - {mean_m: [9, 9], covariance_m2: [[0.1, 0], [0, 0.1]], weight: 0.5}
      - {mean_m: [3, 9], covariance_m2: [[0.1, 0], [0, 0.1]], weight: 0.5}
  - {at_s: 7, action: risk, alpha: 0.3}
  - {at_s: 7.25, action: resume}
  - {at_s: 8, action: clear, robot: 6}
  - {at_s: 60, action: stop}
)";

std::vector<std::filesystem::path> shipped_missions() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(
           std::filesystem::path(SWARM_SOURCE_DIR) / "deploy/missions")) {
    if (entry.path().extension() == ".yaml") files.push_back(entry);
  }
  return files;
}

TEST(MissionFile, FillsInTheDefaults) {
  const auto mission = parse(kLeast, "least");

  ASSERT_TRUE(mission.has_value()) << mission.error().message;
  expect_same(mission->robots, RobotsSpec{}, kRobotsKeys);
  expect_same<BodySpec>(mission->robots, BodySpec{}, kBodyKeys);
  expect_same(mission->link, LinkSpec{}, kLinkKeys);
  EXPECT_EQ(mission->planner.method, PlannerSpec{}.method);
  EXPECT_EQ(mission->planner.options.number("samples"), 500.0);
  EXPECT_EQ(*mission->control.options.find("tracking"), "plan");
  EXPECT_TRUE(mission->script.empty());
}

TEST(MissionFile, HasDefaultsInTheirOwnRanges) {
  const auto mission = parse(kLeast, "least");
  ASSERT_TRUE(mission.has_value());

  const auto again = parse(to_yaml(*mission), "again");

  ASSERT_TRUE(again.has_value()) << again.error().message;
}

TEST(MissionFile, ReadsEverySection) {
  const auto mission = parse(kFull, "full");

  ASSERT_TRUE(mission.has_value()) << mission.error().message;
  EXPECT_EQ(mission->name, "full-1");
  EXPECT_EQ(mission->world.bounds_m().min_m, Vec2(-10, 0));
  EXPECT_EQ(mission->world.obstacles().size(), 3U);
  EXPECT_EQ(mission->robots.count, 7U);
  EXPECT_EQ(mission->start.components().size(), 2U);
  EXPECT_EQ(mission->control.rate_hz, 20.0);
  EXPECT_EQ(mission->control.options.number("look_ahead_s"), 3.3);
  EXPECT_EQ(mission->planner.options.number("samples"), 77.0);
  EXPECT_EQ(*mission->planner.options.find("sampler"), "uniform");
  EXPECT_EQ(mission->launcher.respawn_agent_max, 2U);
  ASSERT_EQ(mission->script.size(), 9U);
  EXPECT_EQ(mission->criteria.w2_ratio_max, 1.15);
  EXPECT_EQ(mission->criteria.own_place_share_min, 0.0);
  EXPECT_FALSE(mission->criteria.centre_lag_max_s.has_value());
  EXPECT_EQ(mission->script[6].at_s, 7.25);
  const auto change = [&](std::size_t i) {
    return std::get<SceneChange>(mission->script[i].action);
  };
  EXPECT_EQ(std::get<Circle>(std::get<AddObstacle>(change(1)).shape).radius_m, 0.3);
  EXPECT_EQ(std::get<MoveObstacle>(change(2)).obstacle, 3U);
  EXPECT_EQ(std::get<MoveObstacle>(change(2)).by_m, Vec2(1, -2));
  EXPECT_EQ(std::get<MoveObstacle>(change(2)).over_s, 4.0);
  EXPECT_EQ(std::get<RemoveObstacle>(change(3)).obstacle, 0U);
  EXPECT_EQ(std::get<GoTo>(change(4)).goal.components().size(), 2U);
  EXPECT_EQ(std::get<SetRisk>(change(5)).alpha, 0.3);
  EXPECT_EQ(std::get<ClearBody>(change(7)).robot, RobotId(6));
  EXPECT_EQ(std::get<CommandKind>(mission->script[8].action), CommandKind::kStop);
}

TEST(MissionFile, ReadsBackWhatItWrote) {
  for (const char* text : {kLeast, kFull}) {
    const auto mission = parse(text, "first");
    ASSERT_TRUE(mission.has_value()) << mission.error().message;

    const auto again = parse(to_yaml(*mission), "again");

    ASSERT_TRUE(again.has_value()) << again.error().message << "\n" << to_yaml(*mission);
    expect_same(*mission, *again);
  }
}

TEST(MissionFile, ReadsADensityCapThatIsAutomatic) {
  const auto cap_of = [](const char* value) {
    return parse(std::string(kLeast) + "planner: {density_cap_per_m2: " + value + "}\n", "m.yaml");
  };
  EXPECT_EQ(parse(kLeast, "least")->planner.density_cap_per_m2, std::nullopt);
  EXPECT_EQ(cap_of("auto")->planner.density_cap_per_m2, std::nullopt);
  EXPECT_EQ(cap_of("0")->planner.density_cap_per_m2, 0.0);
  EXPECT_EQ(cap_of("1.5")->planner.density_cap_per_m2, 1.5);
  for (const char* bad : {"-1", "automatic", "[auto]", "inf"}) {
    const auto mission = cap_of(bad);
    ASSERT_FALSE(mission.has_value()) << bad;
    EXPECT_NE(mission.error().message.find("planner.density_cap_per_m2"), std::string::npos);
  }
}

TEST(MissionFile, ReportsAllViolationsInOrderOfTheFile) {
  const auto mission = parse(
      "version: 3\n"
      "world: {bounds_m: [0, 0, 20, 10]}\n"
      "robots: {count: 0, radius_m: x, wheels: 4}\n"
      "start: [{mean_m: [30, 5], covariance_m2: [[1, 0], [0, 1]], weight: 1}]\n",
      "m.yaml");

  ASSERT_FALSE(mission.has_value());
  const std::string& message = mission.error().message;
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n') + 1, 6) << message;
  std::size_t from = 0;
  for (const char* place : {"m.yaml:1:1: goal is missing", "m.yaml:1:10:", "m.yaml:3:17:",
                            "m.yaml:3:30:", "m.yaml:3:33:", "m.yaml:4:18:"}) {
    const std::size_t at = message.find(place, from);
    ASSERT_NE(at, std::string::npos) << place << " after byte " << from << " of\n" << message;
    from = at;
  }
}

TEST(MissionFile, KeepsAViolationOnOneLine) {
  const auto mission = parse(std::string(kLeast) + "name: \"a\\nb\\e[31m\"\n", "m");

  ASSERT_FALSE(mission.has_value());
  EXPECT_EQ(mission.error().message.find_first_of("\n\x1b"), std::string::npos);
}

TEST(MissionFile, ReportsWhichFileCannotBeRead) {
  const auto missing = load_mission("/nowhere/at all.yaml");
  const auto folder = load_mission("/");

  ASSERT_FALSE(missing.has_value());
  EXPECT_NE(missing.error().message.find("/nowhere/at all.yaml"), std::string::npos);
  ASSERT_FALSE(folder.has_value());
}

TEST(MissionFile, SurvivesAliasBombs) {
  std::string bomb = "a: &a0 [x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 30; ++i) {
    bomb += "b" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
    for (int j = 0; j < 9; ++j) bomb += "*a" + std::to_string(i - 1) + ", ";
    bomb += "]\n";
  }

  EXPECT_FALSE(parse(bomb, "bomb").has_value());
}

TEST(MissionFile, SurvivesDepthAndSizeBombs) {
  const std::size_t large = kMaxMissionBytes;
  for (const std::string& unit :
       {std::string("["),     std::string("{"),     std::string("- "),     std::string("? "),
        std::string("a: "),   std::string("\n"),    std::string("#"),      std::string("\""),
        std::string("'"),     std::string("!"),     std::string("&"),      std::string("*"),
        std::string("%"),     std::string("- a\n"), std::string("a: 1\n"), std::string("[a: "),
        std::string("{a: {"), std::string("\xff"),  std::string("\0", 1),  std::string("|\n"),
        std::string(" ")}) {
    std::string bomb;
    bomb.reserve(large);
    while (bomb.size() + unit.size() <= large / 16) bomb += unit;

    EXPECT_FALSE(parse(bomb, "bomb").has_value()) << unit;
  }
  EXPECT_FALSE(parse(std::string(large + 1, ' '), "too large").has_value());
}

TEST(MissionFile, BoundsTheNumberOfVertices) {
  std::string text = kLeast;
  text.erase(text.find('}'), 1);
  const std::string triangle = "{polygon_m: [[8, 2], [9, 2], [9, 3]]}, ";
  std::string obstacles = ", obstacles: [";
  for (int i = 0; i < 10'001; ++i) obstacles += triangle;
  text.insert(text.find("10]") + 3, obstacles + "]}");

  const auto mission = parse(text, "many");

  ASSERT_FALSE(mission.has_value());
  EXPECT_NE(mission.error().message.find("10001 items; must have between 0 and 10000"),
            std::string::npos)
      << mission.error().message.substr(0, 500);
}

TEST(MissionFile, LoadsEveryShippedMission) {
  const auto files = shipped_missions();
  ASSERT_GE(files.size(), 2U);
  for (const auto& file : files) {
    const auto mission = load_mission(file, builtin_catalogue());

    ASSERT_TRUE(mission.has_value()) << mission.error().message;
    EXPECT_EQ(mission->name, file.stem().string());
  }
}

TEST(MissionFile, ShipsMissionsWhoseStartAndGoalKeepTheRiskPromise) {
  for (const auto& file : shipped_missions()) {
    const auto mission = load_mission(file, builtin_catalogue());
    ASSERT_TRUE(mission.has_value()) << mission.error().message;
    const double k = cvar_coefficient(mission->planner.risk_alpha);

    for (const Mixture* mixture : {&mission->start, &mission->goal}) {
      if (mission->planner.method == "rover") {  // promises it of the mixture as a whole
        EXPECT_LT(max_mixture_cvar_m(*mixture, mission->world, mission->planner.risk_alpha),
                  mission->planner.risk_delta_m)
            << file;
        continue;
      }
      for (const auto& [weight, gaussian] : mixture->components()) {
        EXPECT_TRUE(in_free(gaussian, mission->world, k, mission->planner.risk_delta_m))
            << file << " at " << gaussian.mean_m().transpose() << ", CVaR "
            << max_cvar_m(gaussian, mission->world, k);
      }
    }
  }
}

// The number on a command line replaces the file's before anything is compared with it.
TEST(MissionFile, ComparesEverythingWithTheNumberOfRobotsGiven) {
  const std::string grouped =
      std::string(kLeast) + "robots: {count: 10, groups: [{count: 6}, {count: 4}]}\n";
  const auto with = [&](std::uint32_t robots) {
    return parse_mission(grouped, "m.yaml", {}, builtin_catalogue(), robots);
  };
  ASSERT_TRUE(with(12)) << with(12).error().message;
  EXPECT_EQ(with(12)->robots.count, 12U);
  ASSERT_FALSE(with(5));
  EXPECT_EQ(with(5).error().code, ErrorCode::kBadInput);
  EXPECT_NE(with(5).error().message.find("robots.groups have 10 robots"), std::string::npos);
  EXPECT_NE(with(5).error().message.find("--robots"), std::string::npos);
  EXPECT_EQ(parse_mission(kLeast, "m.yaml", {}, builtin_catalogue(), 5)->robots.count, 5U);
}

}  // namespace
}  // namespace swarm
