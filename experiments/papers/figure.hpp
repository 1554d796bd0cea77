// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "swarmflow/core/linalg.hpp"

namespace swarm::launcher {

/// A curve of a chart with its name in the legend.
struct Line {
  std::string name;
  std::vector<Vec2> points;  ///< x ascending
  bool dots = false;         ///< mark the points: measured at these x alone
};

/// Title and axes of a chart.
struct Axes {
  std::string title, x, y;
  bool log_y = false;  ///< values below 1e-6 of the largest are drawn there
};

/// A chart as a self-contained SVG, for light and dark screens and for print.
std::string figure(const Axes& axes, std::span<const Line> lines);

/// The shares of values that fall into bins of width `bin` from 0 to `high`, as a line with steps;
/// values beyond are in the last bin. \pre bin > 0, high > bin, some value
Line histogram_line(const std::string& name, std::span<const double> values, double bin,
                    double high);

}  // namespace swarm::launcher
