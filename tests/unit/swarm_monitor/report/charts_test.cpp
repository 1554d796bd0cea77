// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/report/charts.hpp"

#include <limits>

#include <gtest/gtest.h>

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
