// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::monitor {

/// Text made safe for the inside of XML and HTML, attributes included; control characters, bytes
/// that are no UTF-8 and characters that XML does not allow become U+FFFD.
std::string escape_xml(std::string_view text);

/// Distance of the marks of an axis: 1, 2 or 5 times a power of ten, at most `steps` times in
/// `span`.
double round_step(double span, double steps);

/// A stroke for a polyline that is at most `tolerance_m` off its points (Douglas–Peucker).
std::vector<Vec2> simplify(std::span<const Vec2> points_m, double tolerance_m);

/// A map of the world as SVG, drawn in the order of the calls. Self-contained, for light and dark
/// screens and for print, alone or inside a page. What lies outside the world's bounds is clipped.
class MapSvg {
 public:
  /// Colours in turn for goals and the tracks that lead there.
  static constexpr std::size_t kColours = 8;

  /// Draws the ground, a scale in metres and the obstacles.
  explicit MapSvg(const World& world);

  /// Components as ellipses: 99 % and one σ, with their index and weight.
  void add_start(const Mixture& mixture);
  void add_goal(const Mixture& mixture);

  /// Legs as faint lines as wide as their mass, nodes as faint one-σ ellipses.
  void add_plan(const FlowPlan& plan);

  /// Many thin lines, such as a roadmap's edges.
  void add_edges(std::span<const std::pair<Vec2, Vec2>> edges_m);

  /// One robot's path with its begin and end; grey without a colour. Ends in a cross if `lost`.
  void add_track(std::span<const Vec2> points_m, std::optional<std::size_t> colour, bool lost);

  /// A ring where something touched, with a tooltip.
  void add_contact(const Vec2& at_m, std::string_view tooltip);

  /// The whole document.
  std::string finish() const;

 private:
  double x(const Vec2& p) const { return margin_px_ + (p.x() - bounds_m_.min_m.x()) * scale_; }
  double y(const Vec2& p) const { return margin_px_ + (bounds_m_.max_m.y() - p.y()) * scale_; }
  std::string point(const Vec2& p) const;
  void add_scale();
  void add_obstacle(const Obstacle& obstacle);
  void add_ellipse(const Gaussian& gaussian, double sigmas, std::string_view css_class);
  void add_mixture(const Mixture& mixture, bool is_goal);

  Box bounds_m_;
  double margin_px_ = 34.0;
  double scale_ = 1.0;  ///< px per metre
  double width_px_ = 0.0, height_px_ = 0.0;
  std::string frame_;  ///< outside the clipped area
  std::string body_;
  std::string labels_;  ///< in front of everything
};

}  // namespace swarm::monitor
