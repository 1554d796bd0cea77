// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/report/svg.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"
#include "tests/unit/swarm_monitor/well_formed.hpp"

namespace swarm::monitor {
namespace {

World make_world(Box bounds) {
  auto l_shape = Polygon::make({{2, 2}, {4, 2}, {4, 3}, {3, 3}, {3, 5}, {2, 5}});
  EXPECT_TRUE(l_shape.has_value());
  auto world = World::make(bounds, {*l_shape, Circle{{7, 7}, 1.0}});
  EXPECT_TRUE(world.has_value());
  return *world;
}

Mixture make_mixture() {
  Mat2 covariance;
  covariance << 1.0, 0.3, 0.3, 0.5;
  auto mixture = Mixture::make({{.weight = 0.25, .gaussian = *Gaussian::make({1, 8}, covariance)},
                                {.weight = 0.75, .gaussian = *Gaussian::make({2, 9}, covariance)}});
  EXPECT_TRUE(mixture.has_value());
  return *mixture;
}

TEST(EscapeXml, LetsNothingThroughThatMarksUp) {
  EXPECT_EQ(escape_xml("a<b>&\"'"), "a&lt;b&gt;&amp;&quot;&#39;");
  EXPECT_EQ(escape_xml("grün 10 µm €"), "grün 10 µm €");
}

TEST(EscapeXml, ReplacesBytesThatAreNoText) {
  const std::string replacement = "\xEF\xBF\xBD";
  EXPECT_EQ(escape_xml("\x01"), replacement);
  EXPECT_EQ(escape_xml("a\xFF"
                       "b"),
            "a" + replacement + "b");
  EXPECT_EQ(escape_xml("\xC3"), replacement);                                      // cut
  EXPECT_EQ(escape_xml("\xC0\xAF"), replacement + replacement);                    // overlong
  EXPECT_EQ(escape_xml("\xED\xA0\x80"), replacement + replacement + replacement);  // surrogate
}

TEST(EscapeXml, ReplacesCharactersThatXmlDoesNotAllow) {
  const std::string replacement = "\xEF\xBF\xBD";
  EXPECT_EQ(escape_xml("a\xEF\xBF\xBE\xEF\xBF\xBF"), "a" + replacement + replacement);
  EXPECT_EQ(escape_xml("\x1B[2J\x7F\r"), replacement + "[2J" + replacement + replacement);
  EXPECT_EQ(escape_xml("a\tb\nc"), "a\tb\nc");
}

TEST(RoundStep, GivesAtMostTheAskedStepsOfOneTwoOrFive) {
  EXPECT_DOUBLE_EQ(round_step(200.0, 6.0), 50.0);
  EXPECT_DOUBLE_EQ(round_step(40.0, 8.0), 5.0);
  EXPECT_DOUBLE_EQ(round_step(0.7, 5.0), 0.2);
}

TEST(Simplify, KeepsEveryPointWithinTheTolerance) {
  Rng rng(3);
  std::vector<Vec2> points{{0, 0}};
  for (int i = 0; i < 500; ++i) {
    points.push_back(points.back() + Vec2(uniform(rng, 0, 1), uniform(rng, -1, 1)));
  }

  const auto kept = simplify(points, 0.5);

  EXPECT_EQ(kept.front(), points.front());
  EXPECT_EQ(kept.back(), points.back());
  EXPECT_LT(kept.size(), points.size() / 2);
  for (const Vec2& p : points) {
    double nearest = 1e9;
    for (std::size_t i = 1; i < kept.size(); ++i) {
      const Vec2 d = kept[i] - kept[i - 1];
      const double t = std::clamp((p - kept[i - 1]).dot(d) / d.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (kept[i - 1] + t * d - p).norm());
    }
    EXPECT_LE(nearest, 0.5 + 1e-12);
  }
}

TEST(RoundStep, IsTheSmallestThatFits) {
  Rng rng(13);
  for (int round = 0; round < 2000; ++round) {
    const double span = std::pow(10.0, uniform(rng, -9.0, 9.0));
    const double steps = uniform(rng, 1.0, 20.0);

    const double step = round_step(span, steps);

    const double power = std::pow(10.0, std::floor(std::log10(step) + 1e-9));
    const double factor = step / power;
    ASSERT_TRUE(std::abs(factor - 1.0) < 1e-9 || std::abs(factor - 2.0) < 1e-9 ||
                std::abs(factor - 5.0) < 1e-9)
        << span << " " << steps;
    EXPECT_GE(step * steps, span * (1.0 - 1e-12));
    const double smaller =
        factor > 1.5 && factor < 2.5 ? step / 2.0 : step / (factor > 4 ? 2.5 : 2.0);
    EXPECT_LT(smaller * steps, span) << "the next smaller one would do";
  }
}

TEST(Simplify, KeepsALoopThatEndsWhereItBegan) {
  //  (0,2) ── (2,2)     The chord from begin to end is a point: distances are those to it.
  //    │        │
  //  (0,0) ── (2,0)
  const std::vector<Vec2> loop{{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}, {0, 0}};

  EXPECT_EQ(simplify(loop, 0.1), (std::vector<Vec2>{{0, 0}, {2, 0}, {2, 2}, {0, 2}, {0, 0}}));
}

TEST(Simplify, LeavesShortStrokesAsTheyAre) {
  for (const std::vector<Vec2>& stroke :
       {std::vector<Vec2>{}, std::vector<Vec2>{{1, 2}}, std::vector<Vec2>{{1, 2}, {1, 2}}}) {
    EXPECT_EQ(simplify(stroke, 10.0), stroke);
  }
  EXPECT_EQ(simplify(std::vector<Vec2>(50, Vec2(3, 4)), 0.0).size(), 2U) << "a robot at rest";
}

TEST(Simplify, ReducesAStraightLineToItsEnds) {
  std::vector<Vec2> points;
  for (int i = 0; i <= 100; ++i) points.emplace_back(0.1 * i, 0.2 * i);

  EXPECT_EQ(simplify(points, 1e-9).size(), 2U);
}

TEST(MapSvg, IsWellFormedWithEverythingDrawn) {
  MapSvg map(make_world({{0, 0}, {10, 10}}));
  map.add_start(make_mixture());
  map.add_goal(make_mixture());
  auto plan = FlowPlan::make(
      {{.gaussian = make_mixture().components()[0].gaussian, .time = MissionTime(0), .mass = 1},
       {.gaussian = make_mixture().components()[1].gaussian, .time = MissionTime(9), .mass = 1}},
      {{.from = 0, .to = 1, .mass = 1.0}});
  ASSERT_TRUE(plan.has_value()) << plan.error().message;
  map.add_plan(*plan);
  const std::vector<std::pair<Vec2, Vec2>> edges{{{1, 1}, {2, 1}}, {{2, 1}, {9, 9}}};
  map.add_edges(edges);
  map.add_track(std::vector<Vec2>{{1, 1}, {5, 1}, {5, 9}}, 11, false);
  map.add_track(std::vector<Vec2>{{1, 1}}, std::nullopt, true);
  map.add_track({}, 0, false);
  map.add_contact({5, 5}, "robots <1> & 2");

  const std::string svg = map.finish();

  EXPECT_EQ(xml_fault(svg), "");
  EXPECT_EQ(count_of(svg, "class=\"obstacle\""), 2U);
  EXPECT_EQ(count_of(svg, "class=\"start\""), 4U);
  EXPECT_EQ(count_of(svg, "class=\"leg\""), 1U);
  EXPECT_EQ(count_of(svg, "class=\"edge\""), 1U);
  EXPECT_EQ(count_of(svg, "class=\"track"), 2U);
  EXPECT_EQ(count_of(svg, "track c3"), 1U) << "goal 11 takes colour 11 mod 8";
  EXPECT_EQ(count_of(svg, "class=\"lost\""), 1U);
  EXPECT_EQ(count_of(svg, "&lt;1&gt; &amp; 2"), 1U);
}

TEST(MapSvg, PutsTheWorldsCornersOnTheImages) {
  MapSvg map(make_world({{-5, -5}, {15, 15}}));
  map.add_track(std::vector<Vec2>{{-5, 15}, {15, -5}}, 0, false);

  // 20 m on 1000 px behind a margin of 34 px; y points down.
  EXPECT_EQ(count_of(map.finish(), "points=\"34.0,34.0 1034.0,1034.0 \""), 1U);
}

TEST(MapSvg, TurnsEllipsesAlongTheirLongAxis) {
  const World world = make_world({{0, 0}, {10, 10}});
  Mat2 covariance;
  covariance << 2.5, 1.5, 1.5, 2.5;  // 4 and 1 m², long axis at +45°
  MapSvg map(world);
  map.add_goal(*Mixture::make({{.weight = 1.0, .gaussian = *Gaussian::make({5, 5}, covariance)}}));

  EXPECT_EQ(
      count_of(map.finish(),
               "rx=\"200.0\" ry=\"100.0\" transform=\"translate(534.0 534.0) rotate(-45.0)\""),
      1U);
}

}  // namespace
}  // namespace swarm::monitor
