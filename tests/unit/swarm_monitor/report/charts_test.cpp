// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/report/charts.hpp"

#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"
#include "tests/unit/swarm_monitor/well_formed.hpp"

namespace swarm::monitor {
namespace {

TEST(LineChart, IsWellFormedForAnyValues) {
  const std::vector<Curve> curves{
      {"a < b", {2.0, 0.5, -0.3, std::numeric_limits<double>::infinity()}}, {"none", {}}};

  const std::string chart = line_chart(curves, 1.0, 2.0, "gap, m");

  EXPECT_EQ(xml_fault(chart), "");
  EXPECT_EQ(count_of(chart, "a &lt; b"), 1U);
  EXPECT_EQ(xml_fault(line_chart({}, 1.0, 2.0, "")), "");
}

TEST(LineChart, DrawsWhatIsAboveTheCapAtIt) {
  const auto points_of = [](const std::string& chart) {
    const std::string begin = "<polyline class=\"curve s0\" points=\"";
    const std::size_t at = chart.find(begin) + begin.size();
    return chart.substr(at, chart.find('"', at) - at);
  };
  const auto chart = [&](double value) {
    return line_chart(std::vector<Curve>{{"gap", {0.5, value}}}, 1.0, 2.0, "m");
  };

  EXPECT_EQ(points_of(chart(2.0)), points_of(chart(1e6)));
  EXPECT_EQ(points_of(chart(2.0)), points_of(chart(std::numeric_limits<double>::infinity())));
  EXPECT_NE(points_of(chart(2.0)), points_of(chart(1.9)));
  EXPECT_EQ(count_of(chart(1.0), "≥2<"), 1U) << "the mark at the cap stands for more, too";
}

/// The counts in the tooltips of one curve's bars, from left to right.
std::vector<int> counts_in(const std::string& chart, const std::string& curve) {
  std::vector<int> counts;
  const std::string begin = "<title>" + curve + ": ";
  for (std::size_t at = chart.find(begin); at != std::string::npos; at = chart.find(begin, at)) {
    at += begin.size();
    counts.push_back(std::stoi(chart.substr(at)));
  }
  return counts;
}

TEST(BarChart, CountsTheValuesOfEachTenth) {
  Rng rng(14);
  Curve curve{"gap", {}};
  std::vector<int> expected(10);
  for (int k = 0; k < 500; ++k) {
    curve.values.push_back(uniform(rng, -1.0, 6.0));
    int tenth = 0;
    while (tenth < 9 && curve.values.back() >= 0.4 * (tenth + 1)) ++tenth;
    ++expected[static_cast<std::size_t>(tenth)];
  }

  const std::string chart = bar_chart(std::vector<Curve>{curve, {"none", {}}}, 4.0, "gap, m");

  EXPECT_EQ(counts_in(chart, "gap"), expected);
  EXPECT_EQ(counts_in(chart, "none"), std::vector<int>(10));
  EXPECT_EQ(xml_fault(chart), "");
}

TEST(BarChart, PutsWhatIsOutsideIntoTheOuterBars) {
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<Curve> curves{{"a", {-infinity, -1.0, 0.0, 2.0, 2.5, infinity}}};

  EXPECT_EQ(counts_in(bar_chart(curves, 2.0, ""), "a"),
            (std::vector<int>{3, 0, 0, 0, 0, 0, 0, 0, 0, 3}));
  EXPECT_EQ(xml_fault(bar_chart({}, 2.0, "a < b")), "");
}

TEST(HistogramChart, IsEmptyWithoutSamples) { EXPECT_EQ(histogram_chart(Histogram{}), ""); }

TEST(HistogramChart, IsWellFormedFromOneSampleToAll) {
  Histogram histogram;
  for (const std::int64_t value : {std::int64_t{0}, std::int64_t{700}, std::int64_t{1} << 35}) {
    histogram.add(value);
    const std::string chart = histogram_chart(histogram);
    EXPECT_EQ(xml_fault(chart), "");
    EXPECT_GE(count_of(chart, "class=\"bar\""), 1U);
  }
}

}  // namespace
}  // namespace swarm::monitor
