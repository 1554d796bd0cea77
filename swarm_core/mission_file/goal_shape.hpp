// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "swarm_core/mission_file/yaml_reader.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/shape_field.hpp"

namespace swarm {

/// A goal given as a shape.
struct DrawnGoal {
  Mixture mixture;                          ///< fitted to it
  std::shared_ptr<const ShapeField> shape;  ///< null where no pixel is at least half dark
};

/// Reads a goal (or start) that is a shape instead of a list of components, and fits a mixture to
/// it:
///
///   {polygon_m: [[x, y], …], components: 12, sigma_min_m: 0.5}
///   {bitmap: {file: q.png, origin_m: [x0, y0], pixel_m: 0.5, dark: true}, components: 20}
///
/// `components` is the number asked for; without it the BIC chooses one up to `components_max`
/// (16). `sigma_min_m` (0.5) is the smallest standard deviation. A bitmap's file is relative to
/// `directory`, its origin_m is the lower left corner. The same shape gives the same mixture; a
/// resolved mission holds the mixture and, as `goal_shape`, the drawing.
///
/// The planner refuses a goal component whose CVaR exceeds δ: at the default α and δ a stroke's
/// middle must be 2.06 σ + 0.2 m from every obstacle, σ being its standard deviation towards it, at
/// least sigma_min_m. Empty after a violation that names `path`.
std::optional<DrawnGoal> read_goal_shape(const yaml::Node& node, const std::string& path,
                                         const std::filesystem::path& directory,
                                         yaml::Violations& violations);

/// Reads the drawing of a resolved mission, a union:
///
///   {polygons_m: [[[x, y], …], …], boxes_m: [[x0, y0, x1, y1], …]}
///
/// Null after a violation that names `path`.
std::shared_ptr<const ShapeField> read_shape_field(const yaml::Node& node, const std::string& path,
                                                   yaml::Violations& violations);

}  // namespace swarm
