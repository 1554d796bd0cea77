// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "swarm_core/metrics/histogram.hpp"

/// Charts as inline SVG, coloured by the page's style sheet.
namespace swarm::monitor {

/// One curve of a chart, with its legend.
struct Curve {
  std::string name;
  std::vector<double> values;  ///< one per step of `step_s`, from 0 on
};

/// Curves over time [s]. Values are shown from the least of all (0 if none is negative) to `cap`,
/// which stands for "this or more".
std::string line_chart(std::span<const Curve> curves, double step_s, double cap,
                       std::string_view title);

/// How many values of each curve (steps do not matter) lie in each tenth of [0, cap]; what is
/// larger counts into the last, what is negative into the first.
std::string bar_chart(std::span<const Curve> curves, double cap, std::string_view title);

/// Shares of samples over a logarithmic axis in milliseconds. Empty text for an empty histogram.
std::string histogram_chart(const Histogram& histogram);

}  // namespace swarm::monitor
