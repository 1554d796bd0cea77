// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/report/svg.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include <fmt/format.h>

namespace swarm::monitor {
namespace {

/// Largest size of a map [px]; the world's aspect ratio decides which one it reaches.
constexpr double kWidth_px = 1000.0;
constexpr double kMostHeight_px = 1000.0;

/// Style of a map: plain properties without variables, because not every SVG viewer supports those.
/// Dark colours apply to screens alone, since prints are light.
constexpr std::string_view kSvgStyle = R"(
.map text{font:11px system-ui,sans-serif;fill:#5b6470}
.map .ground{fill:#fbfaf7;stroke:#9aa3ad}
.map .grid{stroke:#e7e4dc;stroke-width:1}
.map .obstacle{fill:#c9c7c0;stroke:#85827a;stroke-width:1;stroke-linejoin:round}
.map .edge{stroke:#8b95a1;stroke-width:.6;opacity:.35;fill:none}
.map .leg{stroke:#4a5a70;opacity:.16;stroke-linecap:round}
.map .node{fill:none;stroke:#4a5a70;stroke-width:.8;opacity:.18}
.map .start{fill:#6b7480;fill-opacity:.07;stroke:#6b7480;stroke-dasharray:5 4}
.map .goal{fill-opacity:.07;stroke-width:1.4}
.map .label{font-weight:600;text-anchor:middle;fill:#2b323b;stroke:#fbfaf7;stroke-width:3;stroke-opacity:.8;
stroke-linejoin:round;paint-order:stroke}
.map .track{fill:none;stroke-width:1.1;stroke-opacity:.62;stroke-linejoin:round}
.map .begin{fill:#6b7480}
.map .end{stroke:#fff;stroke-width:.8}
.map .lost,.map .contact{fill:none;stroke:#d0021b;stroke-width:2}
.map .contact{fill:#d0021b;fill-opacity:.18}
.map .c0{stroke:#1f77c9}.map .f0{fill:#1f77c9}
.map .c1{stroke:#d9661f}.map .f1{fill:#d9661f}
.map .c2{stroke:#12946b}.map .f2{fill:#12946b}
.map .c3{stroke:#b5559b}.map .f3{fill:#b5559b}
.map .c4{stroke:#c79100}.map .f4{fill:#c79100}
.map .c5{stroke:#3aa6c9}.map .f5{fill:#3aa6c9}
.map .c6{stroke:#7b61c9}.map .f6{fill:#7b61c9}
.map .c7{stroke:#8c6d46}.map .f7{fill:#8c6d46}
.map .cn{stroke:#8a8f98}.map .fn{fill:#8a8f98}
@media screen and (prefers-color-scheme:dark){
.map text{fill:#a4aebb}
.map .ground{fill:#171b21;stroke:#4d5765}
.map .grid{stroke:#252b34}
.map .label{fill:#e4e8ee;stroke:#171b21}
.map .obstacle{fill:#3a414c;stroke:#68717e}
.map .leg,.map .node{stroke:#b9c6d8}
.map .end{stroke:#171b21}
}
)";

/// Length of the UTF-8 character at the front of `text`; 0 if there is no valid one. The lead byte
/// gives the length, continuation bytes are 10xxxxxx.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  const std::size_t n = lead < 0x80                   ? 1
                        : lead >= 0xC2 && lead < 0xE0 ? 2
                        : lead >= 0xE0 && lead < 0xF0 ? 3
                        : lead >= 0xF0 && lead < 0xF5 ? 4
                                                      : 0;
  if (n > text.size()) return 0;
  for (std::size_t i = 1; i < n; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return 0;
  }
  // Overlong forms and surrogates are no valid UTF-8.
  if (n == 3 && ((lead == 0xE0 && byte(1) < 0xA0) || (lead == 0xED && byte(1) >= 0xA0))) return 0;
  if (n == 4 && ((lead == 0xF0 && byte(1) < 0x90) || (lead == 0xF4 && byte(1) >= 0x90))) return 0;
  return n;
}

/// Distance from p to the segment a–b: the projection clamped to the segment.
double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double squared = d.squaredNorm();
  const double t = squared > 0.0 ? std::clamp((p - a).dot(d) / squared, 0.0, 1.0) : 0.0;
  return (a + t * d - p).norm();
}

}  // namespace

/// The smallest of 1, 2, 5, 10 times a power of ten that is not below span/steps.
double round_step(double span, double steps) {
  const double raw = span / steps;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw) return factor * power;
  }
  return 10.0 * power;
}

/// Robot notes and event texts come from other programs: whatever bytes they hold, the page stays
/// valid and runs no script of theirs.
std::string escape_xml(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t n = utf8_length(text);
    const char c = text[0];
    // U+FFFE and U+FFFF are UTF-8, but XML allows them nowhere.
    const std::string_view shown = text.substr(0, n);
    const bool excluded = shown == "\xEF\xBF\xBE" || shown == "\xEF\xBF\xBF";
    const bool control = n == 1 && static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t';
    if (n == 0 || control || excluded || c == 0x7F) {
      out += "\xEF\xBF\xBD";
    } else if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else if (c == '\'') {
      out += "&#39;";
    } else {
      out.append(shown);
    }
    text.remove_prefix(std::max<std::size_t>(n, 1));
  }
  return out;
}

/// Douglas–Peucker with a stack instead of recursion, since a track has thousands of points: keeps
/// the point farthest from the chord if it is off by more than the tolerance, and splits there. O(n
/// log n) typically, O(n²) at worst.
std::vector<Vec2> simplify(std::span<const Vec2> points_m, double tolerance_m) {
  if (points_m.size() < 3) return {points_m.begin(), points_m.end()};
  std::vector<bool> keep(points_m.size(), false);
  keep.front() = keep.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, points_m.size() - 1}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    double worst = tolerance_m;
    std::size_t split = first;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double off = distance_to_segment(points_m[i], points_m[first], points_m[last]);
      if (off <= worst) continue;
      worst = off;
      split = i;
    }
    if (split == first) continue;
    keep[split] = true;
    open.emplace_back(first, split);
    open.emplace_back(split, last);
  }
  std::vector<Vec2> kept;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    if (keep[i]) kept.push_back(points_m[i]);
  }
  return kept;
}

MapSvg::MapSvg(const World& world) : bounds_m_(world.bounds_m()) {
  const Vec2 size_m = bounds_m_.max_m - bounds_m_.min_m;
  scale_ = std::min(kWidth_px / size_m.x(), kMostHeight_px / size_m.y());
  width_px_ = size_m.x() * scale_ + 2.0 * margin_px_;
  height_px_ = size_m.y() * scale_ + 2.0 * margin_px_;
  add_scale();
  for (const Obstacle& obstacle : world.obstacles()) add_obstacle(obstacle);
}

std::string MapSvg::point(const Vec2& p) const { return fmt::format("{:.1f},{:.1f}", x(p), y(p)); }

/// Ground, grid lines at round coordinates, and their labels.
void MapSvg::add_scale() {
  const Vec2& low = bounds_m_.min_m;
  const Vec2& high = bounds_m_.max_m;
  auto ground = std::back_inserter(frame_);
  fmt::format_to(ground,
                 "<rect class=\"ground\" x=\"{0:.1f}\" y=\"{0:.1f}\" width=\"{1:.1f}\" "
                 "height=\"{2:.1f}\"/>\n",
                 margin_px_, width_px_ - 2 * margin_px_, height_px_ - 2 * margin_px_);
  const double step = round_step((high - low).maxCoeff(), 6.0);
  const double bottom = height_px_ - margin_px_;
  for (double value = std::ceil(low.x() / step) * step; value <= high.x() + 1e-9; value += step) {
    const double at = x({value, 0.0});
    fmt::format_to(ground, "<path class=\"grid\" d=\"M{0:.1f},{1:.1f}V{2:.1f}\"/>", at, margin_px_,
                   bottom);
    fmt::format_to(ground, "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:g}</text>\n",
                   at, bottom + 16, value);
  }
  for (double value = std::ceil(low.y() / step) * step; value <= high.y() + 1e-9; value += step) {
    const double at = y({0.0, value});
    fmt::format_to(ground, "<path class=\"grid\" d=\"M{0:.1f},{1:.1f}H{2:.1f}\"/>", margin_px_, at,
                   width_px_ - margin_px_);
    fmt::format_to(ground, "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{:g}</text>\n",
                   margin_px_ - 5, at + 4, value);
  }
  fmt::format_to(ground, "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">metres</text>\n",
                 width_px_ - margin_px_, margin_px_ - 8);
}

void MapSvg::add_obstacle(const Obstacle& obstacle) {
  auto out = std::back_inserter(body_);
  if (const auto* circle = std::get_if<Circle>(&obstacle)) {
    fmt::format_to(out, "<circle class=\"obstacle\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>\n",
                   x(circle->center_m), y(circle->center_m), circle->radius_m * scale_);
    return;
  }
  fmt::format_to(out, "<polygon class=\"obstacle\" points=\"");
  for (const Vec2& vertex : std::get<Polygon>(obstacle).vertices_m()) {
    fmt::format_to(out, "{} ", point(vertex));
  }
  fmt::format_to(out, "\"/>\n");
}

void MapSvg::add_ellipse(const Gaussian& gaussian, double sigmas, std::string_view css_class) {
  const Mat2& c = gaussian.covariance_m2();
  // Principal axes of a symmetric 2×2 matrix in closed form: eigenvalues m ± √(((a − d)/2)² + b²)
  // with m = (a + d)/2, angle ½ atan2(2b, a − d).
  const double middle = 0.5 * (c(0, 0) + c(1, 1));
  const double spread = std::hypot(0.5 * (c(0, 0) - c(1, 1)), c(0, 1));
  const double angle = 0.5 * std::atan2(2.0 * c(0, 1), c(0, 0) - c(1, 1));
  const Vec2& mean = gaussian.mean_m();
  fmt::format_to(std::back_inserter(body_),
                 "<ellipse class=\"{}\" rx=\"{:.1f}\" ry=\"{:.1f}\" "
                 "transform=\"translate({:.1f} {:.1f}) rotate({:.1f})\"/>\n",
                 css_class, sigmas * std::sqrt(middle + spread) * scale_,
                 sigmas * std::sqrt(std::max(0.0, middle - spread)) * scale_, x(mean), y(mean),
                 -angle * 180.0 / std::numbers::pi);
}

/// The 99 % ellipse of a 2-D Gaussian has the radius √χ²₂(0.99) = 3.03 σ.
void MapSvg::add_mixture(const Mixture& mixture, bool is_goal) {
  const double sigmas_99 = std::sqrt(kChiSquared2Dof99);
  for (std::size_t i = 0; i < mixture.components().size(); ++i) {
    const auto& [weight, gaussian] = mixture.components()[i];
    const std::size_t colour = i % kColours;
    const std::string css_class =
        is_goal ? fmt::format("goal c{0} f{0}", colour) : std::string("start");
    add_ellipse(gaussian, sigmas_99, css_class);
    add_ellipse(gaussian, 1.0, css_class);
    fmt::format_to(std::back_inserter(labels_),
                   "<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\">{} {}: {:.3g} %</text>\n",
                   x(gaussian.mean_m()), y(gaussian.mean_m()) + 4, is_goal ? "goal" : "start", i,
                   100.0 * weight);
  }
}

void MapSvg::add_start(const Mixture& mixture) { add_mixture(mixture, false); }

void MapSvg::add_goal(const Mixture& mixture) { add_mixture(mixture, true); }

void MapSvg::add_plan(const FlowPlan& plan) {
  for (const PlanLeg& leg : plan.legs()) {
    fmt::format_to(std::back_inserter(body_),
                   "<path class=\"leg\" stroke-width=\"{:.1f}\" d=\"M{} {}\"/>\n",
                   2.0 + 16.0 * leg.mass, point(plan.nodes()[leg.from].gaussian.mean_m()),
                   point(plan.nodes()[leg.to].gaussian.mean_m()));
  }
  for (const PlanNode& node : plan.nodes()) add_ellipse(node.gaussian, 1.0, "node");
}

void MapSvg::add_edges(std::span<const std::pair<Vec2, Vec2>> edges_m) {
  if (edges_m.empty()) return;
  body_ += "<path class=\"edge\" d=\"";
  for (const auto& [from, to] : edges_m) {
    fmt::format_to(std::back_inserter(body_), "M{} {}", point(from), point(to));
  }
  body_ += "\"/>\n";
}

void MapSvg::add_track(std::span<const Vec2> points_m, std::optional<std::size_t> colour,
                       bool lost) {
  if (points_m.empty()) return;
  // Points closer to the line than 0.4 px are invisible; leaving them out keeps the file small.
  constexpr double kTolerance_px = 0.4;
  const std::string c = colour ? fmt::format("{}", *colour % kColours) : "n";
  auto out = std::back_inserter(body_);
  fmt::format_to(out, "<polyline class=\"track c{}\" points=\"", c);
  for (const Vec2& p : simplify(points_m, kTolerance_px / scale_)) {
    fmt::format_to(out, "{} ", point(p));
  }
  fmt::format_to(out, "\"/><circle class=\"begin\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.6\"/>",
                 x(points_m.front()), y(points_m.front()));
  const double end_x = x(points_m.back());
  const double end_y = y(points_m.back());
  if (lost) {
    fmt::format_to(out, "<path class=\"lost\" d=\"M{0:.1f},{1:.1f}l10,10m0,-10l-10,10\"/>\n",
                   end_x - 5, end_y - 5);
  } else {
    fmt::format_to(out, "<circle class=\"end f{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>\n", c,
                   end_x, end_y);
  }
}

void MapSvg::add_contact(const Vec2& at_m, std::string_view tooltip) {
  fmt::format_to(std::back_inserter(body_),
                 "<circle class=\"contact\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"9\">"
                 "<title>{}</title></circle>\n",
                 x(at_m), y(at_m), escape_xml(tooltip));
}

std::string MapSvg::finish() const {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"map\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "role=\"img\" aria-label=\"map\">\n<style>{2}</style>\n"
      "<clipPath id=\"world\"><rect x=\"{3:.1f}\" y=\"{3:.1f}\" width=\"{4:.1f}\" "
      "height=\"{5:.1f}\"/></clipPath>\n{6}<g clip-path=\"url(#world)\">\n{7}</g>\n{8}</svg>\n",
      width_px_, height_px_, kSvgStyle, margin_px_, width_px_ - 2 * margin_px_,
      height_px_ - 2 * margin_px_, frame_, body_, labels_);
}

}  // namespace swarm::monitor
