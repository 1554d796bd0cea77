// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/scene_json.hpp"

#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/unit/swarm_monitor/bus_samples.hpp"

namespace swarm::monitor {
namespace {

using Json = nlohmann::json;

Mixture one_at(double x, double y) {
  Mat2 covariance;
  covariance << 4.0, 0.5, 0.5, 1.0;
  return Mixture::make({{1.0, Gaussian::from_valid({x, y}, covariance)}}).value();
}

TEST(SceneJson, HasTheKeysOfTheProtocol) {
  Mission mission = four_robots();
  mission.start = one_at(1, 2);
  mission.link.group_cell_size_m = 5.0;
  mission.link.cell_size_m = 100.0;
  const auto square = Polygon::make({{1, 1}, {2, 1}, {2, 2}, {1, 2}}).value();
  const World world = World::make({{0, 0}, {40, 20}}, {square, Circle{{20, 10}, 2.0}}).value();
  const Mixture goal = one_at(30, 10);
  const FlowPlan plan = straight_plan();

  const Json scene = Json::parse(scene_json({.mission = mission,
                                             .world = world,
                                             .goal = goal,
                                             .plan = &plan,
                                             .plan_excess_m = 0.25,
                                             .from_s = 1.5,
                                             .end_s = 61.5,
                                             .live = true,
                                             .control = true}));

  const Json gaussian = {{"mean", {1.0, 2.0}}, {"cov", {4.0, 0.5, 1.0}}, {"weight", 1.0}};
  EXPECT_EQ(scene["op"], "scene");
  EXPECT_EQ(scene["t"], 1.5);
  EXPECT_EQ(scene["end"], 61.5);
  EXPECT_EQ(scene["name"], "four");
  EXPECT_EQ(scene["live"], true);
  EXPECT_EQ(scene["control"], true);
  EXPECT_EQ(scene["robots"], 4);
  EXPECT_EQ(scene["radius_m"], mission.robots.radius_m);
  EXPECT_EQ(scene["bounds"], Json::parse("[[0.0,0.0],[40.0,20.0]]"));
  EXPECT_EQ(scene["origin"], Json::parse("[0.0,0.0]"));
  ASSERT_EQ(scene["obstacles"].size(), 2U);
  EXPECT_EQ(scene["obstacles"][0]["id"], 0);
  EXPECT_EQ(scene["obstacles"][0]["polygon"].size(), 4U);
  EXPECT_EQ(scene["obstacles"][1]["id"], 1);
  EXPECT_EQ(scene["obstacles"][1]["circle"], Json::parse("[20.0,10.0,2.0]"));
  EXPECT_EQ(scene["start"], Json::array({gaussian}));
  EXPECT_EQ(scene["goal"][0]["mean"], Json::parse("[30.0,10.0]"));
  EXPECT_EQ(scene["plan"]["nodes"][1]["t"], 30.0);
  EXPECT_EQ(scene["plan"]["nodes"][1]["mean"], Json::parse("[35.0,10.0]"));
  EXPECT_EQ(scene["plan"]["legs"], Json::parse("[[0,1,1.0]]"));
  EXPECT_EQ(scene["plan_excess_m"], 0.25);
  EXPECT_EQ(scene["cell_m"], 5.0);
  EXPECT_EQ(scene["hearing_m"], mission.link.communication_radius_m);
}

TEST(SceneJson, HasNoPlanUntilThereIsOneAndTheCellsOfItsChannel) {
  Mission mission = four_robots();
  mission.link.cell_size_m = 100.0;
  const Mixture goal = one_at(30, 10);

  const Json scene = Json::parse(scene_json(
      {.mission = mission, .world = mission.world, .goal = goal, .channel = Channel::kTopics}));

  EXPECT_TRUE(scene["plan"].is_null());
  EXPECT_EQ(scene["cell_m"], 100.0);
  EXPECT_EQ(scene["end"], 0.0) << "while the run is in progress";
}

TEST(EventJson, IsTextWhateverBytesTheEventHolds) {
  const Json event = Json::parse(event_json({.time_s = 1.25,
                                             .source = "robot-3",
                                             .severity = "warning",
                                             .code = "a\"b",
                                             .text = "cut \xC3"}));

  EXPECT_EQ(event["t"], 1.25);
  EXPECT_EQ(event["source"], "robot-3");
  EXPECT_EQ(event["severity"], "warning");
  EXPECT_EQ(event["code"], "a\"b");
  EXPECT_EQ(event["text"], "cut \xEF\xBF\xBD");
}

TEST(SeriesJson, HasTheColumnsOfTheProtocolAndNullForWhatIsNotKnown) {
  EXPECT_EQ(Json::parse(series_json({.time_s = 2.0,
                                     .nearest_gap_m = 0.5,
                                     .arrived = 3,
                                     .moving = 4,
                                     .latency_ms = 1.5,
                                     .rate_hz = 24.0})),
            Json::parse("[2.0,0.5,3,4,1.5,24.0]"));
  EXPECT_EQ(Json::parse(series_json({.nearest_gap_m = std::numeric_limits<double>::infinity(),
                                     .latency_ms = std::numeric_limits<double>::quiet_NaN(),
                                     .rate_hz = -std::numeric_limits<double>::infinity()})),
            Json::parse("[0.0,null,0,0,null,null]"));
}

}  // namespace
}  // namespace swarm::monitor
