// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission_file/mission_shapes.hpp"

#include <utility>

#include <fmt/format.h>

#include "swarm_core/mission_file/goal_shape.hpp"
#include "swarm_core/mission_file/reader_bounds.hpp"

namespace swarm {

using yaml::MapReader;
using yaml::Node;
using yaml::Position;
using yaml::Range;

namespace {

using reader_bounds::kCoordinate_m;
// A wide bound on each entry; Gaussian::make() then checks the matrix as a whole.
constexpr Range kVariance_m2 = between(-1e12, 1e12);
constexpr Range kWeight = positive(1);

}  // namespace

// Corners in the order of the file: lower left, then upper right.
std::optional<Box> ShapeReader::read_bounds(const Node& node) {
  const auto b = yaml::read_numbers(node, "world.bounds_m", 4, kCoordinate_m, violations_);
  if (!b) return std::nullopt;
  if (!((*b)[0] < (*b)[2] && (*b)[1] < (*b)[3])) {
    violations_.add(node.at,
                    "world.bounds_m is empty; must be [x0, y0, x1, y1] with x0 < x1 and y0 < y1");
    return std::nullopt;
  }
  return Box{.min_m = {(*b)[0], (*b)[1]}, .max_m = {(*b)[2], (*b)[3]}};
}

// Exactly one of the two shapes must be given.
std::optional<Obstacle> ShapeReader::read_obstacle(MapReader& keys, const std::string& path,
                                                   Position at) {
  const Node* polygon = keys.take("polygon_m");
  const Node* circle = keys.take("circle_m");
  if (keys.is_map() && (polygon == nullptr) == (circle == nullptr)) {
    violations_.add(at, fmt::format("{} has {}; must have one of polygon_m and circle_m", path,
                                    polygon == nullptr ? "no shape" : "two shapes"));
    return std::nullopt;
  }
  if (polygon != nullptr) return read_polygon(*polygon, path + ".polygon_m");
  if (circle != nullptr) return read_circle(*circle, path + ".circle_m");
  return std::nullopt;
}

std::optional<Obstacle> ShapeReader::read_polygon(const Node& node, const std::string& path) {
  const auto* items = yaml::read_list(node, path, 3, Polygon::kMaxVertices, violations_);
  if (items == nullptr) return std::nullopt;
  // The total is bounded over all polygons of a file, since each alone may be within its own bound.
  vertices_ += items->size();
  if (vertices_ > reader_bounds::kMaxVertices) {
    violations_.add(node.at, fmt::format("{}: {} vertices so far; must be <= {} in all polygons "
                                         "together",
                                         path, vertices_, reader_bounds::kMaxVertices));
    return std::nullopt;
  }
  std::vector<Vec2> vertices;
  for (std::size_t i = 0; i < items->size(); ++i) {
    const auto p = yaml::read_numbers((*items)[i], fmt::format("{}[{}]", path, i), 2, kCoordinate_m,
                                      violations_);
    if (p) vertices.emplace_back((*p)[0], (*p)[1]);
  }
  if (vertices.size() != items->size()) return std::nullopt;
  auto polygon = Polygon::make(std::move(vertices));
  if (polygon) return std::move(*polygon);
  violations_.add(node.at, fmt::format("{}: {}", path, polygon.error().message));
  return std::nullopt;
}

std::optional<Obstacle> ShapeReader::read_circle(const Node& node, const std::string& path) {
  MapReader keys(node, path, violations_);
  std::optional<std::vector<double>> center;
  std::optional<double> radius;
  if (const Node* value = keys.take("center", true)) {
    center = yaml::read_numbers(*value, keys.path_of("center"), 2, kCoordinate_m, violations_);
  }
  if (const Node* value = keys.take("radius", true)) {
    radius = yaml::read_number(*value, keys.path_of("radius"),
                               positive(reader_bounds::kMaxExtent_m), violations_);
  }
  keys.finish();
  if (!center || !radius) return std::nullopt;
  return Circle{.center_m = {(*center)[0], (*center)[1]}, .radius_m = *radius};
}

// A mapping is a drawn shape, a list holds the components themselves.
std::optional<Mixture> ShapeReader::read_mixture(const Node& node, const std::string& path,
                                                 const MeanRule& rule,
                                                 std::shared_ptr<const ShapeField>* drawing) {
  if (node.kind == Node::Kind::kMap) return read_shape(node, path, rule, drawing);
  const auto* items = yaml::read_list(node, path, 1, reader_bounds::kMaxComponents, violations_);
  if (items == nullptr) return std::nullopt;
  std::vector<WeightedGaussian> components;
  for (std::size_t i = 0; i < items->size(); ++i) {
    auto component = read_component((*items)[i], fmt::format("{}[{}]", path, i), rule);
    if (component) components.push_back(*component);
  }
  if (components.size() != items->size()) return std::nullopt;
  auto mixture = Mixture::make(std::move(components));
  if (mixture) return std::move(*mixture);
  violations_.add(node.at, fmt::format("{}: {}", path, mixture.error().message));
  return std::nullopt;
}

// The fitted means must satisfy the same rule as written ones: a shape over an obstacle is a
// violation.
std::optional<Mixture> ShapeReader::read_shape(const Node& node, const std::string& path,
                                               const MeanRule& rule,
                                               std::shared_ptr<const ShapeField>* drawing) {
  auto drawn = read_goal_shape(node, path, directory_, violations_);
  if (!drawn) return std::nullopt;
  const auto& components = drawn->mixture.components();
  for (std::size_t i = 0; i < components.size(); ++i) {
    check_mean(node.at, fmt::format("{}: mean of fitted component {}", path, i),
               components[i].gaussian.mean_m(), rule);
  }
  if (drawing != nullptr) *drawing = std::move(drawn->shape);
  return std::move(drawn->mixture);
}

// The covariance is checked as a matrix only when all three keys could be read, so that one mistake
// gives one message.
std::optional<WeightedGaussian> ShapeReader::read_component(const Node& node,
                                                            const std::string& path,
                                                            const MeanRule& rule) {
  MapReader keys(node, path, violations_);
  std::optional<std::vector<double>> mean;
  std::optional<Mat2> covariance;
  std::optional<double> weight;
  const Node* mean_node = keys.take("mean_m", true);
  const Node* covariance_node = keys.take("covariance_m2", true);
  if (mean_node != nullptr) {
    mean = yaml::read_numbers(*mean_node, path + ".mean_m", 2, kCoordinate_m, violations_);
  }
  if (covariance_node != nullptr) {
    covariance = read_covariance(*covariance_node, path + ".covariance_m2");
  }
  if (const Node* value = keys.take("weight", true)) {
    weight = yaml::read_number(*value, path + ".weight", kWeight, violations_);
  }
  keys.finish();
  if (mean) check_mean(mean_node->at, path + ".mean_m", {(*mean)[0], (*mean)[1]}, rule);
  if (!mean || !covariance || !weight) return std::nullopt;
  auto gaussian = Gaussian::make({(*mean)[0], (*mean)[1]}, *covariance);
  if (!gaussian) {
    violations_.add(covariance_node->at,
                    fmt::format("{}.covariance_m2: {}", path, gaussian.error().message));
    return std::nullopt;
  }
  return WeightedGaussian{.weight = *weight, .gaussian = *gaussian};
}

std::optional<Mat2> ShapeReader::read_covariance(const Node& node, const std::string& path) {
  const auto* rows = yaml::read_list(node, path, 2, 2, violations_);
  if (rows == nullptr) return std::nullopt;
  const auto row0 = yaml::read_numbers((*rows)[0], path + "[0]", 2, kVariance_m2, violations_);
  const auto row1 = yaml::read_numbers((*rows)[1], path + "[1]", 2, kVariance_m2, violations_);
  if (!row0 || !row1) return std::nullopt;
  Mat2 covariance;
  covariance << (*row0)[0], (*row0)[1], (*row1)[0], (*row1)[1];
  return covariance;
}

// Only means are checked; how far the spread of a Gaussian may reach towards an obstacle is the
// planner's risk limit.
void ShapeReader::check_mean(Position at, const std::string& path, const Vec2& mean_m,
                             const MeanRule& rule) {
  if (rule.world == nullptr) return;
  const std::string is = fmt::format("{} is ({}, {})", path, mean_m.x(), mean_m.y());
  if (!rule.world->bounds_m().contains(mean_m)) {
    violations_.add(at, is + ", outside the world; must lie within world.bounds_m");
    return;
  }
  if (!rule.clear_of_obstacles) return;
  const double distance_m = rule.world->distance_m(mean_m);
  if (distance_m >= rule.radius_m) return;
  violations_.add(at, distance_m < 0.0
                          ? is + ", inside an obstacle; must be free"
                          : fmt::format("{}, {:.3g} m from an obstacle; must be at least "
                                        "robots.radius_m ({})",
                                        is, distance_m, rule.radius_m));
}

}  // namespace swarm
