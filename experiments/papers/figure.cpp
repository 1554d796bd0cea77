// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/papers/figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "swarm_core/base/assert.hpp"
#include "swarm_monitor/report/svg.hpp"

namespace swarm::launcher {
namespace {

// Sizes in px.
constexpr double kWidth = 720.0, kHeight = 400.0;
constexpr double kLeft = 64.0, kRight = 16.0, kTop = 58.0, kBottom = 48.0;
constexpr double kInnerWidth = kWidth - kLeft - kRight;
constexpr double kInnerHeight = kHeight - kTop - kBottom;
constexpr double kLeastShare = 1e-6;  // of the largest value, on a logarithmic axis
constexpr double kLegend = 170.0;     // px a name

// Okabe and Ito's palette, distinguishable with every form of colour vision.
constexpr std::array kColours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                              "#e69f00", "#56b4e9", "#999999"};

constexpr std::string_view kStyle =
    "<style>text{font:13px sans-serif;fill:#222}.grid{stroke:#ddd;fill:none}"
    ".line{fill:none;stroke-width:1.8;stroke-linejoin:round}rect{fill:#fff}"
    "@media(prefers-color-scheme:dark){text{fill:#ddd}.grid{stroke:#444}rect{fill:#181818}}"
    "</style>\n";

/// Maps values to pixels.
struct Axis {
  double low, high, begin_px, length_px;
  double at(double value) const { return begin_px + (value - low) / (high - low) * length_px; }
};

/// Range of the values of all lines; y begins at 0 or below.
struct Extent {
  double x_low = 0.0, x_high = 0.0, y_low = 0.0, y_high = 0.0;
};

/// Never empty, so that an axis can be divided by its length.
Extent extent_of(std::span<const Line> lines) {
  Extent e;
  bool first = true;
  for (const Line& line : lines) {
    for (const Vec2& p : line.points) {
      e.x_low = first ? p.x() : std::min(e.x_low, p.x());
      e.x_high = first ? p.x() : std::max(e.x_high, p.x());
      e.y_low = std::min(e.y_low, p.y());
      e.y_high = first ? p.y() : std::max(e.y_high, p.y());
      first = false;
    }
  }
  if (!(e.x_high > e.x_low)) e.x_high = e.x_low + 1.0;
  if (!(e.y_high > e.y_low)) e.y_high = e.y_low + 1.0;
  return e;
}

/// Grid line and label of a value on the x axis.
void tick_x(std::string& out, double px, double value) {
  fmt::format_to(std::back_inserter(out),
                 "<path class=\"grid\" d=\"M{0:.1f},{1}V{2}\"/><text x=\"{0:.1f}\" y=\"{3}\" "
                 "text-anchor=\"middle\">{4:g}</text>\n",
                 px, kTop, kTop + kInnerHeight, kTop + kInnerHeight + 17, value);
}

/// Grid line and label of a value on the y axis.
void tick_y(std::string& out, double px, double value) {
  fmt::format_to(std::back_inserter(out),
                 "<path class=\"grid\" d=\"M{0},{1:.1f}H{2}\"/><text x=\"{3}\" y=\"{4:.1f}\" "
                 "text-anchor=\"end\">{5:.3g}</text>\n",
                 kLeft, px, kLeft + kInnerWidth, kLeft - 6, px + 4, value);
}

/// Position on the axis: the value, or its logarithm. Values near 0 are drawn at the lower end.
double to_axis(const Axes& axes, const Extent& extent, double y) {
  return axes.log_y ? std::log10(std::max(y, kLeastShare * extent.y_high)) : y;
}

/// Draws the grid of the y axis: multiples of a round step, or powers of ten. The axis ends at a
/// grid line on both sides. Pixels grow downwards, hence the negative length.
Axis add_y_axis(std::string& out, const Axes& axes, const Extent& extent,
                std::span<const Line> lines) {
  Axis y{extent.y_low, extent.y_high, kTop + kInnerHeight, -kInnerHeight};
  if (!axes.log_y) {
    const double step = monitor::round_step(y.high - y.low, 6.0);
    y.high = step * std::ceil(y.high / step - 1e-9);
    y.low = step * std::floor(y.low / step + 1e-9);
    for (double v = y.low; v <= y.high + 1e-9 * step; v += step) tick_y(out, y.at(v), v + 0.0);
    return y;
  }
  // Logarithmic: whole decades from the largest value down to the smallest drawn one.
  y.high = std::ceil(std::log10(extent.y_high));
  y.low = y.high - 1.0;
  for (const Line& line : lines) {
    for (const Vec2& p : line.points) {
      y.low = std::min(y.low, std::floor(to_axis(axes, extent, p.y())));
    }
  }
  for (double v = y.low; v <= y.high; v += 1.0) tick_y(out, y.at(v), std::pow(10.0, v));
  return y;
}

}  // namespace

std::string figure(const Axes& axes, std::span<const Line> lines) {
  const Extent extent = extent_of(lines);
  std::string body = fmt::format("<rect width=\"{}\" height=\"{}\"/>\n", kWidth, kHeight);
  auto out = std::back_inserter(body);
  const Axis x{extent.x_low, extent.x_high, kLeft, kInnerWidth};
  const double step = monitor::round_step(x.high - x.low, 10.0);
  // The tolerance of 1e-9 keeps ticks at the ends in spite of rounding; + 0.0 turns −0 into 0.
  for (double v = step * std::ceil(x.low / step - 1e-9); v <= x.high + 1e-9 * step; v += step) {
    tick_x(body, x.at(v), v + 0.0);
  }
  const Axis y = add_y_axis(body, axes, extent, lines);
  // Each line as a polyline, its marked points, and its entry in the legend above the chart.
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const char* colour = kColours[i % kColours.size()];
    fmt::format_to(out, "<polyline class=\"line\" stroke=\"{}\" points=\"", colour);
    for (const Vec2& p : lines[i].points) {
      fmt::format_to(out, "{:.1f},{:.1f} ", x.at(p.x()), y.at(to_axis(axes, extent, p.y())));
    }
    body += "\"/>\n";
    for (const Vec2& p : lines[i].points) {
      if (!lines[i].dots) break;
      fmt::format_to(out, "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n",
                     x.at(p.x()), y.at(to_axis(axes, extent, p.y())), colour);
    }
    const double at = kLeft + kLegend * static_cast<double>(i);
    fmt::format_to(out,
                   "<path class=\"line\" stroke=\"{}\" d=\"M{:.1f},{}h18\"/><text x=\"{:.1f}\" "
                   "y=\"{}\">{}</text>\n",
                   colour, at, kTop - 18, at + 24, kTop - 14, monitor::escape_xml(lines[i].name));
  }
  // Title and names of the axes.
  fmt::format_to(out, "<text x=\"{}\" y=\"20\" font-weight=\"bold\">{}</text>\n", kLeft,
                 monitor::escape_xml(axes.title));
  fmt::format_to(out, "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                 kLeft + 0.5 * kInnerWidth, kHeight - 10, monitor::escape_xml(axes.x));
  fmt::format_to(out,
                 "<text transform=\"translate(16,{}) rotate(-90)\" text-anchor=\"middle\">{}"
                 "</text>\n",
                 kTop + 0.5 * kInnerHeight, monitor::escape_xml(axes.y));
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" role=\"img\">\n{}{}</svg>\n",
      kWidth, kHeight, kStyle, body);
}

/// Values beyond the last bin are clamped into it. Each bin is two points, so that the line has
/// steps.
Line histogram_line(const std::string& name, std::span<const double> values, double bin,
                    double high) {
  SWARM_ASSERT(bin > 0.0 && high > bin && !values.empty());
  const auto bins = static_cast<std::size_t>(std::ceil(high / bin - 1e-9));
  std::vector<double> shares(bins, 0.0);
  for (const double value : values) {
    // The last bin is entered at its middle, so that rounding cannot leave the range.
    const double at = std::clamp(value / bin, 0.0, static_cast<double>(bins) - 0.5);
    shares[static_cast<std::size_t>(at)] += 1.0 / static_cast<double>(values.size());
  }
  Line line{.name = name, .points = {{0.0, 0.0}}};
  for (std::size_t i = 0; i < bins; ++i) {
    line.points.emplace_back(static_cast<double>(i) * bin, shares[i]);
    line.points.emplace_back(static_cast<double>(i + 1) * bin, shares[i]);
  }
  line.points.emplace_back(static_cast<double>(bins) * bin, 0.0);
  return line;
}

}  // namespace swarm::launcher
