// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "swarm_core/mission_file/yaml_reader.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/shape_field.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm {

/// Where the means of a mixture may lie.
struct MeanRule {
  const World* world = nullptr;    ///< inside its bounds; null = anywhere
  bool clear_of_obstacles = true;  ///< and as far as `radius_m` from its obstacles
  double radius_m = 0.0;
};

/// Reads obstacles and mixtures from mission files and from commands to a running mission. It
/// reports mistakes to `violations`, which must outlive the reader.
class ShapeReader {
 public:
  /// Names of bitmap files are relative to `directory`.
  explicit ShapeReader(yaml::Violations& violations, std::filesystem::path directory = {})
      : violations_(violations), directory_(std::move(directory)) {}

  /// The shape given by one of the keys polygon_m and circle_m. `path` and `at` are path and
  /// position of the mapping; the caller reads its other keys.
  std::optional<Obstacle> read_obstacle(yaml::MapReader& keys, const std::string& path,
                                        yaml::Position at);

  /// The rectangle of the world, [x0, y0, x1, y1].
  std::optional<Box> read_bounds(const yaml::Node& node);

  /// A list of components with mean_m, covariance_m2 and weight, or a shape to fit them to
  /// (goal_shape.hpp). `drawing`, if given, is set to that shape.
  std::optional<Mixture> read_mixture(const yaml::Node& node, const std::string& path,
                                      const MeanRule& rule,
                                      std::shared_ptr<const ShapeField>* drawing = nullptr);

 private:
  std::optional<Obstacle> read_polygon(const yaml::Node& node, const std::string& path);
  std::optional<Obstacle> read_circle(const yaml::Node& node, const std::string& path);
  std::optional<WeightedGaussian> read_component(const yaml::Node& node, const std::string& path,
                                                 const MeanRule& rule);
  std::optional<Mat2> read_covariance(const yaml::Node& node, const std::string& path);
  void check_mean(yaml::Position at, const std::string& path, const Vec2& mean_m,
                  const MeanRule& rule);

  std::optional<Mixture> read_shape(const yaml::Node& node, const std::string& path,
                                    const MeanRule& rule,
                                    std::shared_ptr<const ShapeField>* drawing);

  yaml::Violations& violations_;
  std::filesystem::path directory_;
  std::size_t vertices_ = 0;  // of all polygons so far
};

}  // namespace swarm
