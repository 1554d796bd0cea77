// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/papers/figure.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <regex>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::launcher {
namespace {

// The pixels of each line of a chart.
std::vector<std::vector<Vec2>> pixels(const std::string& svg) {
  static const std::regex kPolyline("<polyline[^>]* points=\"([^\"]*)\"");
  static const std::regex kPoint("([-0-9.]+),([-0-9.]+)");
  std::vector<std::vector<Vec2>> lines;
  for (std::sregex_iterator line(svg.begin(), svg.end(), kPolyline), end; line != end; ++line) {
    const std::string points = (*line)[1];
    lines.emplace_back();
    for (std::sregex_iterator p(points.begin(), points.end(), kPoint); p != end; ++p) {
      lines.back().emplace_back(std::stod((*p)[1]), std::stod((*p)[2]));
    }
  }
  return lines;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

Axes axes(bool log_y) { return {.title = "title", .x = "x", .y = "y", .log_y = log_y}; }

constexpr double kRounding_px = 0.1;  // coordinates have one decimal

TEST(Figure, MapsValuesLinearlyWithYUpwards) {
  const std::vector<Line> lines{{.name = "a", .points = {{0, 0}, {1, 1}, {4, 3}, {10, 7}}}};

  const std::vector<Vec2> px = pixels(figure(axes(false), lines)).at(0);

  ASSERT_EQ(px.size(), 4U);
  const Vec2 one = px[1] - px[0];
  EXPECT_GT(one.x(), 0.0);
  EXPECT_LT(one.y(), 0.0);
  EXPECT_NEAR((px[2] - px[0]).x(), (px[3] - px[0]).x() * 0.4, kRounding_px);
  EXPECT_NEAR((px[1] - px[0]).x(), (px[3] - px[0]).x() * 0.1, kRounding_px);
  EXPECT_NEAR((px[2] - px[0]).y(), (px[3] - px[0]).y() * 3.0 / 7.0, kRounding_px);
}

TEST(Figure, MapsFactorsToDistancesOnALogarithmicAxis) {
  const std::vector<Line> lines{
      {.name = "a", .points = {{0, 0.02}, {1, 0.2}, {2, 2.0}, {3, 20.0}, {4, 1e-5}, {5, 0.0}}}};

  const std::vector<Vec2> px = pixels(figure(axes(true), lines)).at(0);

  ASSERT_EQ(px.size(), 6U);
  const double decade_px = px[0].y() - px[1].y();
  EXPECT_GT(decade_px, 0.0);
  EXPECT_NEAR(px[1].y() - px[2].y(), decade_px, 2 * kRounding_px);
  EXPECT_NEAR(px[2].y() - px[3].y(), decade_px, 2 * kRounding_px);
  // A millionth of 20 is the least value that is drawn: six decades below the largest.
  EXPECT_NEAR(px[4].y() - px[3].y(), 6.0 * decade_px, 7 * kRounding_px);
  EXPECT_EQ(px[5].y(), px[4].y());
}

TEST(Figure, DrawsEverythingInsideItsFrame) {
  Rng rng(1);
  for (int i = 0; i < 200; ++i) {
    std::vector<Line> lines(1 + rng() % 4);
    const double scale = std::pow(10.0, uniform(rng, -6.0, 6.0));
    const bool log_y = rng() % 2 == 0;
    for (Line& line : lines) {
      line.dots = rng() % 2 == 0;
      double x = uniform(rng, -5.0, 5.0);
      for (std::uint64_t k = rng() % 10; k > 0; --k) {
        line.points.emplace_back(x, scale * uniform(rng, log_y ? 0.0 : -1.0, 1.0));
        x += uniform(rng, 0.0, 3.0);
      }
    }

    const std::string svg = figure(axes(log_y), lines);

    const auto drawn = pixels(svg);
    ASSERT_EQ(drawn.size(), lines.size());
    std::size_t dots = 0;
    for (std::size_t l = 0; l < lines.size(); ++l) {
      ASSERT_EQ(drawn[l].size(), lines[l].points.size());
      dots += lines[l].dots ? lines[l].points.size() : 0;
      for (const Vec2& px : drawn[l]) {
        EXPECT_GE(px.x(), 64.0 - kRounding_px);
        EXPECT_LE(px.x(), 704.0 + kRounding_px);
        EXPECT_GE(px.y(), 58.0 - kRounding_px);
        EXPECT_LE(px.y(), 352.0 + kRounding_px);
      }
    }
    EXPECT_EQ(count(svg, "<circle"), dots);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
  }
}

TEST(Figure, DrawsNothingAndLinesWithoutExtent) {
  const std::vector<std::vector<Line>> cases{{},
                                             {{.name = "empty", .points = {}}},
                                             {{.name = "point", .points = {{3, 4}}}},
                                             {{.name = "flat", .points = {{0, 0}, {9, 0}}}},
                                             {{.name = "upright", .points = {{2, 0}, {2, 5}}}},
                                             {{.name = "below", .points = {{0, -3}, {1, -2}}}}};
  for (const auto& lines : cases) {
    for (const bool log_y : {false, true}) {
      if (log_y && !lines.empty() && lines[0].name == "below") continue;  // has no logarithm
      const std::string svg = figure(axes(log_y), lines);
      EXPECT_EQ(svg.find("nan"), std::string::npos);
      EXPECT_EQ(svg.find("inf"), std::string::npos);
      EXPECT_EQ(count(svg, "<polyline"), lines.size());
      EXPECT_TRUE(svg.ends_with("</svg>\n"));
    }
  }
}

TEST(Figure, EscapesEveryName) {
  const std::vector<Line> lines{{.name = "a<b", .points = {}}};

  const std::string svg = figure({.title = "R&D", .x = "\"x\"", .y = "y>0"}, lines);

  for (const char* raw : {"a<b", "R&D", "\"x\"<", ">y>0"}) {
    EXPECT_EQ(svg.find(raw), std::string::npos) << raw;
  }
  EXPECT_NE(svg.find("a&lt;b"), std::string::npos);
  EXPECT_NE(svg.find("R&amp;D"), std::string::npos);
}

TEST(Figure, HasTheLegendOfEveryLineInside) {
  for (const std::size_t number : {1U, 2U, 4U}) {
    const std::vector<Line> lines(number, Line{.name = "name", .points = {}});
    const std::string svg = figure(axes(false), lines);
    static const std::regex kEntry("<text x=\"([0-9.]+)\" y=\"44\">name</text>");
    std::vector<double> begins;
    for (std::sregex_iterator e(svg.begin(), svg.end(), kEntry), end; e != end; ++e) {
      begins.push_back(std::stod((*e)[1]));
    }
    ASSERT_EQ(begins.size(), number);
    EXPECT_LT(begins.back(), 704.0 - 40.0) << "of " << number;
    for (std::size_t i = 1; i < number; ++i) EXPECT_GT(begins[i], begins[i - 1] + 60.0);
  }
}

// The share of each bin, read from the upper corners of the steps.
std::vector<double> shares(const Line& line, double bin) {
  std::vector<double> all;
  EXPECT_EQ(line.points.front(), Vec2(0, 0));
  for (std::size_t i = 1; i + 2 < line.points.size(); i += 2) {
    EXPECT_EQ(line.points[i].y(), line.points[i + 1].y()) << "a step is level";
    EXPECT_NEAR(line.points[i + 1].x() - line.points[i].x(), bin, 1e-12);
    all.push_back(line.points[i].y());
  }
  EXPECT_EQ(line.points.back().y(), 0.0);
  return all;
}

TEST(HistogramLine, CountsEveryValueOnce) {
  Rng rng(2);
  for (int i = 0; i < 100; ++i) {
    std::vector<double> values(1 + rng() % 50);
    for (double& value : values) value = uniform(rng, 0.0, 3.0);
    std::vector<double> expected(8, 0.0);  // 0.25 wide, up to 2; the last one has what is beyond
    for (const double value : values) {
      std::size_t bin = 0;
      while (bin < 7 && value >= 0.25 * static_cast<double>(bin + 1)) ++bin;
      expected[bin] += 1.0 / static_cast<double>(values.size());
    }

    const std::vector<double> found = shares(histogram_line("gaps", values, 0.25, 2.0), 0.25);

    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t b = 0; b < expected.size(); ++b) EXPECT_NEAR(found[b], expected[b], 1e-12);
    EXPECT_NEAR(std::accumulate(found.begin(), found.end(), 0.0), 1.0, 1e-12);
  }
}

TEST(HistogramLine, CoversTheRangeWithWholeBins) {
  const std::vector<double> values{0.05, 1e300};
  // 0.1 does not divide 1 exactly in binary: ten bins, not eleven. 0.3 needs four.
  EXPECT_EQ(shares(histogram_line("a", values, 0.1, 1.0), 0.1).size(), 10U);
  const std::vector<double> wide = shares(histogram_line("a", values, 0.3, 1.0), 0.3);
  EXPECT_EQ(wide, (std::vector<double>{0.5, 0.0, 0.0, 0.5}));
}

}  // namespace
}  // namespace swarm::launcher
