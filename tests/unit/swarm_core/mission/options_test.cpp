// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "swarmflow/mission/catalogue.hpp"
#include "swarmflow/mission/mission_file.hpp"
#include "swarmflow/mission/option_table.hpp"

namespace swarm {
namespace {

struct Spiral {
  double gain_hz = 0.1;
  std::uint32_t turns = 3;
  std::string sense = "left";
};

OptionTable<Spiral> table() {
  return OptionTable<Spiral>()
      .number("gain_hz", &Spiral::gain_hz, positive(10), "speed per metre off the path")
      .count("turns", &Spiral::turns, between(1, 100), "turns before it gives up")
      .choice("sense", &Spiral::sense, {"left", "right"}, "to which side it turns");
}

TEST(OptionTable, TakesDefaultsFromTheStruct) {
  const auto specs = table().specs();
  ASSERT_EQ(specs.size(), 3U);
  const OptionSpec& first = specs[0];
  EXPECT_EQ(first.key, "gain_hz");
  EXPECT_EQ(first.fallback, "0.1");
  EXPECT_EQ(specs[1].fallback, "3");
  EXPECT_EQ(specs[2].fallback, "left");
  EXPECT_EQ(table().read({}).gain_hz, 0.1);
}

TEST(OptionTable, ReadsWhatIsSet) {
  OptionValues values;
  values.set("gain_hz", 0.30000000000000004);
  values.set("turns", 7);
  values.set("sense", "right");
  const Spiral spiral = table().read(values);
  EXPECT_EQ(spiral.gain_hz, 0.30000000000000004);
  EXPECT_EQ(spiral.turns, 7U);
  EXPECT_EQ(spiral.sense, "right");
}

TEST(OptionTable, SharesKeysWithOthers) {
  struct Wide : Spiral {
    double width_m = 2.0;
  };
  const auto wide = OptionTable<Wide>().with(table()).number("width_m", &Wide::width_m, positive(9),
                                                             "of the turns");
  OptionValues values;
  values.set("turns", 7);
  values.set("width_m", "+4");
  ASSERT_EQ(wide.specs().size(), 4U);
  EXPECT_EQ(wide.read(values).turns, 7U);
  EXPECT_EQ(wide.read(values).gain_hz, 0.1);
  EXPECT_EQ(wide.read(values).width_m, 4.0);
}

TEST(Catalogue, IsTheSameAfterJson) {
  Catalogue catalogue;
  catalogue.control_methods.push_back({"spiral", "Turns around its path", table().specs()});
  catalogue.control_methods[0].options[0].at_most = "turns";
  catalogue.control_methods[0].shape_tolerance = "turns";
  catalogue.drivers.push_back({"cart", "Rolls", {}, {.fixed_s = 0.2, .turns = true}});
  const auto read = catalogue_from_json(to_json(catalogue), "agent");
  ASSERT_TRUE(read);
  ASSERT_EQ(read->control_methods.size(), 1U);
  EXPECT_EQ(read->control_methods[0].name, "spiral");
  EXPECT_EQ(read->control_methods[0].options, catalogue.control_methods[0].options);
  EXPECT_EQ(read->control_methods[0].shape_tolerance, "turns");
  ASSERT_EQ(read->drivers.size(), 1U);
  EXPECT_EQ(read->drivers[0].lag, catalogue.drivers[0].lag);
}

TEST(Catalogue, RefusesWhatIsNoDescription) {
  EXPECT_FALSE(catalogue_from_json("usage: my_agent --help", "my_agent"));
  EXPECT_FALSE(catalogue_from_json("{}", "my_agent"));
}

constexpr const char* kMission = R"(version: 1
robots: {count: 1, model: my_robot, port: 7}
world: {bounds_m: [0, 0, 60, 30]}
start: [{mean_m: [10, 15], covariance_m2: [[1, 0], [0, 1]], weight: 1}]
goal: [{mean_m: [50, 15], covariance_m2: [[1, 0], [0, 1]], weight: 1}]
planner: {method: my_planner, depth: 3}
control: {method: spiral, gain_hz: 0.5}
)";

TEST(OpenCatalogue, KeepsNamesAndKeysThatItDoesNotKnow) {
  const auto mission = parse_mission(kMission, "m.yaml", {}, open_catalogue());
  ASSERT_TRUE(mission) << mission.error().message;
  EXPECT_EQ(mission->planner.method, "my_planner");
  EXPECT_EQ(mission->planner.options.number("depth"), 3.0);
  EXPECT_EQ(mission->control.options.number("gain_hz"), 0.5);
  EXPECT_EQ(mission->robots.options.number("port"), 7.0);
  const auto again = parse_mission(to_yaml(*mission), "m.yaml", {}, open_catalogue());
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->robots.options, mission->robots.options);
}

struct Cart {
  std::string port = "/dev/ttyUSB0";
};

Catalogue carts() {
  Catalogue catalogue = open_catalogue();
  const auto table = OptionTable<Cart>().text("port", &Cart::port, "where it is connected");
  catalogue.drivers.push_back({"cart", "Rolls", table.specs()});
  return catalogue;
}

Result<Mission> cart_at(const std::string& port) {
  std::string text = kMission;
  const std::string kRobots = "model: my_robot, port: 7";
  text.replace(text.find(kRobots), kRobots.size(), "model: cart, port: " + port);
  return parse_mission(text, "m.yaml", {}, carts());
}

TEST(TextOption, IsTheSameInTheResolvedMission) {
  for (const std::string port :
       {"/dev/ttyUSB0", "r{id}", "udp://10.0.0.1:14550", "null", "-", "a b: #c", "7", "", "'x'"}) {
    const auto mission = cart_at("\"" + port + "\"");
    ASSERT_TRUE(mission) << mission.error().message;
    ASSERT_NE(mission->robots.options.find("port"), nullptr) << port;
    EXPECT_EQ(*mission->robots.options.find("port"), port);
    for (const Catalogue& catalogue : {carts(), open_catalogue()}) {
      const auto again = parse_mission(to_yaml(*mission), "m.yaml", {}, catalogue);
      ASSERT_TRUE(again) << again.error().message;
      EXPECT_EQ(again->robots.options, mission->robots.options) << port;
    }
  }
}

TEST(TextOption, RefusesWhatIsLongOrNotPrintable) {
  for (const std::string& port : {std::string(kMaxOptionText + 1, 'a'), std::string("caf\xC3\xA9"),
                                  std::string("a\\tb"), std::string("a\\\"b")}) {
    const auto mission = cart_at("\"" + port + "\"");
    ASSERT_FALSE(mission) << port;
    EXPECT_NE(mission.error().message.find("m.yaml:2:39: robots.port must have at most 200"),
              std::string::npos)
        << mission.error().message;
  }
}

TEST(Mission, HasTheLagOfItsDriversForProgramsWithoutThem) {
  Catalogue drivers = open_catalogue();
  drivers.drivers.push_back({"my_robot", "Rolls", {}, {.fixed_s = 0.25, .accelerates = true}});
  const auto mission = parse_mission(kMission, "m.yaml", {}, drivers);
  ASSERT_TRUE(mission) << mission.error().message;
  EXPECT_EQ(mission->robots.lag_s, 0.25 + 1.5 / 3.0);

  const auto planners = parse_mission(to_yaml(*mission), "m.yaml", {}, open_catalogue());
  ASSERT_TRUE(planners) << planners.error().message;
  EXPECT_EQ(planners->robots.lag_s, mission->robots.lag_s);
}

TEST(Mission, MayGiveTheLagItself) {
  Catalogue drivers = open_catalogue();
  drivers.drivers.push_back({"my_robot", "Rolls", {}, {.fixed_s = 0.25}});
  std::string text = kMission;
  text.replace(text.find("port: 7"), 7, "lag_s: 0.1");
  EXPECT_EQ(parse_mission(text, "m.yaml", {}, drivers)->robots.lag_s, 0.1);
}

/// What a guest's control method declares is known to the audit, which does not have the method.
TEST(Mission, HasTheShapeToleranceOfItsMethodForProgramsWithoutIt) {
  Catalogue methods = open_catalogue();
  methods.control_methods.push_back(
      {"spiral", "Fills the drawing", table().specs(), {}, "gain_hz"});
  const auto mission = parse_mission(kMission, "m.yaml", {}, methods);
  ASSERT_TRUE(mission) << mission.error().message;
  EXPECT_EQ(mission->control.shape_tolerance_m2, 0.5);

  const auto audits = parse_mission(to_yaml(*mission), "m.yaml", {}, open_catalogue());
  ASSERT_TRUE(audits) << audits.error().message;
  EXPECT_EQ(audits->control.shape_tolerance_m2, 0.5);
}

TEST(Mission, HasNoShapeToleranceOfAMethodThatDeclaresNone) {
  Catalogue methods = open_catalogue();
  methods.control_methods.push_back({"spiral", "Turns around its path", table().specs()});
  const auto mission = parse_mission(kMission, "m.yaml", {}, methods);
  ASSERT_TRUE(mission) << mission.error().message;
  EXPECT_FALSE(mission->control.shape_tolerance_m2);
}

TEST(ClosedCatalogue, RefusesThem) {
  EXPECT_FALSE(parse_mission(kMission, "m.yaml", {}, Catalogue{}));
}

}  // namespace
}  // namespace swarm
