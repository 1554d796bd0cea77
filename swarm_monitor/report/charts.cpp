// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/report/charts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "swarm_monitor/report/svg.hpp"

namespace swarm::monitor {
namespace {

/// Size of a chart and its margins for labels [px].
constexpr double kWidth = 640.0, kHeight = 240.0;
constexpr double kLeft = 46.0, kRight = 14.0, kTop = 14.0, kBottom = 34.0;
constexpr double kInnerWidth = kWidth - kLeft - kRight;
constexpr double kInnerHeight = kHeight - kTop - kBottom;

/// A linear map from [low, high] to pixels; a negative length runs upwards.
struct Axis {
  double low, high, begin_px, length_px;
  double at(double value) const { return begin_px + (value - low) / (high - low) * length_px; }
};

/// The SVG element around a chart. It scales with the page by its view box.
std::string document(const std::string& body) {
  return fmt::format("<svg class=\"chart\" viewBox=\"0 0 {} {}\" role=\"img\">\n{}</svg>\n", kWidth,
                     kHeight, body);
}

void add_tick_x(std::string& out, double px, std::string_view label) {
  fmt::format_to(std::back_inserter(out),
                 "<path class=\"grid\" d=\"M{0:.1f},{1}V{2}\"/>"
                 "<text x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4}</text>\n",
                 px, kTop, kTop + kInnerHeight, kTop + kInnerHeight + 15, label);
}

void add_tick_y(std::string& out, double px, std::string_view label) {
  fmt::format_to(std::back_inserter(out),
                 "<path class=\"grid\" d=\"M{0},{1:.1f}H{2}\"/>"
                 "<text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>\n",
                 kLeft, px, kLeft + kInnerWidth, kLeft - 6, px + 4, label);
}

void add_title_x(std::string& out, std::string_view title) {
  fmt::format_to(std::back_inserter(out),
                 "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                 kLeft + 0.5 * kInnerWidth, kHeight - 3, escape_xml(title));
}

}  // namespace

/// Polylines of step curves. Values above `cap` are drawn at it, which its tick marks with ≥, so
/// that one outlier does not flatten the curves.
std::string line_chart(std::span<const Curve> curves, double step_s, double cap,
                       std::string_view title) {
  double low = 0.0;
  std::size_t steps = 1;
  for (const Curve& curve : curves) {
    steps = std::max(steps, curve.values.size());
    for (const double value : curve.values) low = std::min(low, value);
  }
  const Axis time{0.0, static_cast<double>(steps) * step_s, kLeft, kInnerWidth};
  const Axis gap{low, cap, kTop + kInnerHeight, -kInnerHeight};
  std::string body;
  const double time_step = round_step(time.high, 8.0);
  for (double t = 0.0; t <= time.high + 1e-9; t += time_step) {
    add_tick_x(body, time.at(t), fmt::format("{:g}", t));
  }
  const double gap_step = round_step(cap - low, 5.0);
  for (double g = std::ceil(low / gap_step) * gap_step; g <= cap + 1e-9; g += gap_step) {
    const bool is_cap = g > cap - 0.5 * gap_step;
    add_tick_y(body, gap.at(g), fmt::format("{}{:.3g}", is_cap ? "≥" : "", g + 0.0));
  }
  auto out = std::back_inserter(body);
  fmt::format_to(out, "<path class=\"zero\" d=\"M{},{:.1f}H{}\"/>\n", kLeft, gap.at(0.0),
                 kLeft + kInnerWidth);
  for (std::size_t c = 0; c < curves.size(); ++c) {
    fmt::format_to(out, "<polyline class=\"curve s{}\" points=\"", c);
    const std::vector<double>& values = curves[c].values;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double value = gap.at(std::min(values[k], cap));
      // Each value holds for a whole step.
      fmt::format_to(out, "{:.1f},{:.1f} {:.1f},{:.1f} ", time.at(static_cast<double>(k) * step_s),
                     value, time.at(static_cast<double>(k + 1) * step_s), value);
    }
    fmt::format_to(out, "\"/>\n<path class=\"curve s{0}\" d=\"M{1},{2}h16\"/>", c,
                   kLeft + 12 + 150 * static_cast<double>(c), kTop + 10);
    fmt::format_to(out, "<text x=\"{}\" y=\"{}\">{}</text>\n",
                   kLeft + 33 + 150 * static_cast<double>(c), kTop + 14,
                   escape_xml(curves[c].name));
  }
  fmt::format_to(out, "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\n",
                 kLeft + kInnerWidth - 6, kTop + 14, escape_xml(title));
  add_title_x(body, "time since the first step, s");
  return document(body);
}

/// Grouped bars: ten equal bins over [0, cap], the last one open upwards.
std::string bar_chart(std::span<const Curve> curves, double cap, std::string_view title) {
  constexpr std::size_t kBars = 10;
  std::vector<std::array<std::size_t, kBars>> counts(curves.size());
  std::size_t most = 1;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    for (const double value : curves[c].values) {
      const double bar = std::clamp(value / cap * kBars, 0.0, kBars - 1.0);
      most = std::max(most, ++counts[c][static_cast<std::size_t>(bar)]);
    }
  }
  const Axis gap{0.0, cap, kLeft, kInnerWidth};
  const Axis count{0.0, 1.08 * static_cast<double>(most), kTop + kInnerHeight, -kInnerHeight};
  std::string body;
  const double count_step = std::max(1.0, round_step(static_cast<double>(most), 4.0));
  for (double n = 0.0; n <= count.high; n += count_step) {
    add_tick_y(body, count.at(n), fmt::format("{:g}", n));
  }
  for (std::size_t bar = 0; bar <= kBars; bar += 2) {
    const double at = cap * static_cast<double>(bar) / kBars;
    add_tick_x(body, gap.at(at), fmt::format("{}{:g}", bar == kBars ? "≥" : "", at));
  }
  auto out = std::back_inserter(body);
  const double slot = kInnerWidth / kBars;
  const double width = (slot - 8.0) / static_cast<double>(std::max<std::size_t>(1, curves.size()));
  for (std::size_t c = 0; c < curves.size(); ++c) {
    for (std::size_t bar = 0; bar < kBars; ++bar) {
      const double top = count.at(static_cast<double>(counts[c][bar]));
      fmt::format_to(out,
                     "<rect class=\"bar s{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" "
                     "height=\"{:.1f}\"><title>{}: {}</title></rect>\n",
                     c,
                     kLeft + slot * static_cast<double>(bar) + 4.0 + width * static_cast<double>(c),
                     top, width, count.at(0.0) - top, escape_xml(curves[c].name), counts[c][bar]);
    }
    fmt::format_to(out,
                   "<rect class=\"bar s{}\" x=\"{}\" y=\"{}\" width=\"10\" height=\"10\"/>"
                   "<text x=\"{}\" y=\"{}\">{}</text>\n",
                   c, kLeft + 12 + 150 * static_cast<double>(c), kTop + 4,
                   kLeft + 28 + 150 * static_cast<double>(c), kTop + 14,
                   escape_xml(curves[c].name));
  }
  add_title_x(body, title);
  return document(body);
}

/// Bars of equal width in log₂ of the age, with marks at the median and
/// the 99 % quantile.
std::string histogram_chart(const Histogram& histogram) {
  if (histogram.count() == 0) return {};
  // Two bars per power of two: 16 bins are more than a chart shows.
  constexpr std::size_t kBinsPerBar = 8;
  std::vector<double> tops_log2, shares;
  double bottom_log2 = 0.0;
  std::size_t first_bar = Histogram::kBins, last_bar = 0;
  for (std::size_t bin = 0; bin < Histogram::kBins; bin += kBinsPerBar) {
    std::uint64_t count = 0;
    for (std::size_t i = bin; i < bin + kBinsPerBar; ++i) count += histogram.bin(i);
    const std::int64_t top_us = Histogram::top_us(bin + kBinsPerBar - 1) + 1;
    tops_log2.push_back(std::log2(static_cast<double>(top_us)));
    shares.push_back(static_cast<double>(count) / static_cast<double>(histogram.count()));
    if (count == 0) continue;
    first_bar = std::min(first_bar, shares.size() - 1);
    last_bar = shares.size() - 1;
  }
  bottom_log2 = first_bar == 0 ? 0.0 : tops_log2[first_bar - 1];
  const double most = *std::max_element(shares.begin(), shares.end());
  const Axis age{bottom_log2, tops_log2[last_bar], kLeft, kInnerWidth};
  const Axis share{0.0, most * 1.08, kTop + kInnerHeight, -kInnerHeight};
  std::string body;
  const double share_step = round_step(most, 4.0);
  for (double s = 0.0; s <= share.high; s += share_step) {
    add_tick_y(body, share.at(s), fmt::format("{:.3g} %", 100.0 * s));
  }
  for (double us = 1.0; us < 1e10; us *= 10.0) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double log2 = std::log2(us * factor);
      const bool wide = age.high - age.low > 7.0;
      if (log2 < age.low || log2 > age.high || (wide && factor != 1.0)) continue;
      add_tick_x(body, age.at(log2), fmt::format("{:g}", us * factor / 1000.0));
    }
  }
  for (std::size_t bar = first_bar; bar <= last_bar; ++bar) {
    const double left = age.at(bar == 0 ? 0.0 : tops_log2[bar - 1]);
    const double top = share.at(shares[bar]);
    fmt::format_to(std::back_inserter(body),
                   "<rect class=\"bar\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" "
                   "height=\"{:.1f}\"><title>{:.3g} %</title></rect>\n",
                   left + 0.5, top, std::max(0.5, age.at(tops_log2[bar]) - left - 1.0),
                   share.at(0.0) - top, 100.0 * shares[bar]);
  }
  const std::array<std::pair<double, const char*>, 2> marks{{{0.5, "p50"}, {0.99, "p99"}}};
  for (const auto& [q, name] : marks) {
    const double us = static_cast<double>(std::max<std::int64_t>(1, histogram.quantile_us(q)));
    const double px = age.at(std::clamp(std::log2(us), age.low, age.high));
    fmt::format_to(std::back_inserter(body),
                   "<path class=\"mark\" d=\"M{0:.1f},{1}V{2}\"/>"
                   "<text x=\"{3:.1f}\" y=\"{4}\">{5}</text>\n",
                   px, kTop, kTop + kInnerHeight, px + 3, kTop + 8, name);
  }
  add_title_x(body, "age of a neighbour's state when used, ms");
  return document(body);
}

}  // namespace swarm::monitor
