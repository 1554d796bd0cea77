// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission_file/scene_change_file.hpp"

#include <fmt/format.h>

#include "swarm_core/mission_file/reader_bounds.hpp"
#include "swarm_core/mission_file/yaml_point.hpp"

namespace swarm {

using yaml::MapReader;
using yaml::Node;

namespace {

// Reads the keys of one change from a mapping; one function for each kind of change.
class ChangeReader {
 public:
  ChangeReader(MapReader& keys, const World& mission_world, yaml::Violations& violations)
      : keys_(keys), mission_world_(mission_world), violations_(violations) {}

  std::optional<SceneChange> move() {
    const auto obstacle = read_obstacle_number();
    std::optional<std::vector<double>> by_m;
    std::optional<double> over_s = 0.0;
    if (const Node* node = keys_.take("by_m", true)) {
      by_m = yaml::read_numbers(*node, keys_.path_of("by_m"), 2,
                                between(-reader_bounds::kMaxExtent_m, reader_bounds::kMaxExtent_m),
                                violations_);
    }
    if (const Node* node = keys_.take("over_s")) {
      over_s = yaml::read_number(*node, keys_.path_of("over_s"), reader_bounds::kScriptTime_s,
                                 violations_);
    }
    if (!obstacle || !by_m || !over_s) return std::nullopt;
    return MoveObstacle{*obstacle, {(*by_m)[0], (*by_m)[1]}, *over_s};
  }

  std::optional<SceneChange> remove() {
    const auto obstacle = read_obstacle_number();
    if (!obstacle) return std::nullopt;
    return RemoveObstacle{*obstacle};
  }

  std::optional<SceneChange> go_to(ShapeReader& shapes) {
    const Node* node = keys_.take("goal", true);
    if (node == nullptr) return std::nullopt;
    // Obstacles may be added and removed until then: the planner checks whether the goal is free.
    auto goal = shapes.read_mixture(*node, keys_.path_of("goal"),
                                    {.world = &mission_world_, .clear_of_obstacles = false});
    if (!goal) return std::nullopt;
    return GoTo{std::move(*goal)};
  }

  // The launcher writes this change to the scene log; scripts cannot use it.
  std::optional<SceneChange> add_body(const std::string& path, yaml::Position at,
                                      ShapeReader& shapes) {
    const auto robot = read_robot();
    const auto shape = shapes.read_obstacle(keys_, path, at);
    if (!robot || !shape) return std::nullopt;
    const auto* circle = std::get_if<Circle>(&*shape);
    if (circle == nullptr) {
      violations_.add(at, fmt::format("{}: a body is a circle_m", path));
      return std::nullopt;
    }
    return AddBody{*robot, *circle};
  }

  std::optional<SceneChange> clear() {
    const auto robot = read_robot();
    if (!robot) return std::nullopt;
    return ClearBody{*robot};
  }

  std::optional<SceneChange> risk() {
    const Node* node = keys_.take("alpha", true);
    if (node == nullptr) return std::nullopt;
    const auto alpha =
        yaml::read_number(*node, keys_.path_of("alpha"), kRiskAlphaRange, violations_);
    if (!alpha) return std::nullopt;
    return SetRisk{*alpha};
  }

 private:
  std::optional<RobotId> read_robot() {
    const Node* node = keys_.take("robot", true);
    if (node == nullptr) return std::nullopt;
    const auto number =
        yaml::read_count(*node, keys_.path_of("robot"), between(0, kMaxRobots - 1), violations_);
    if (!number) return std::nullopt;
    return RobotId(*number);
  }

  // Whether the obstacle exists depends on the scene at that time and is checked by after().
  std::optional<std::uint32_t> read_obstacle_number() {
    const Node* node = keys_.take("obstacle", true);
    if (node == nullptr) return std::nullopt;
    return yaml::read_count(*node, keys_.path_of("obstacle"), between(0, 1e6), violations_);
  }

  MapReader& keys_;
  const World& mission_world_;
  yaml::Violations& violations_;
};

std::string keys_of_shape(const Obstacle& shape) {
  if (const auto* circle = std::get_if<Circle>(&shape)) {
    return fmt::format("circle_m: {{center: {}, radius: {}}}", yaml_point(circle->center_m),
                       circle->radius_m);
  }
  std::string text;
  for (const Vec2& vertex : std::get<Polygon>(shape).vertices_m()) {
    text += (text.empty() ? "" : ", ") + yaml_point(vertex);
  }
  return fmt::format("polygon_m: [{}]", text);
}

// Flow style, since the change must fit on one line.
std::string keys_of_goal(const Mixture& goal) {
  std::string text;
  for (const auto& [weight, gaussian] : goal.components()) {
    const Mat2& c = gaussian.covariance_m2();
    text += fmt::format("{}{{mean_m: {}, covariance_m2: [[{}, {}], [{}, {}]], weight: {}}}",
                        text.empty() ? "" : ", ", yaml_point(gaussian.mean_m()), c(0, 0), c(0, 1),
                        c(1, 0), c(1, 1), weight);
  }
  return fmt::format("goal: [{}]", text);
}

// The usual helper that lets std::visit() take one lambda for each alternative.
template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;  // clang 14 does not deduce it

}  // namespace

// An unknown action gives an empty result without a violation: the caller has checked the name or
// reports it.
std::optional<SceneChange> read_scene_change(std::string_view action, MapReader& keys,
                                             const std::string& path, yaml::Position at,
                                             ShapeReader& shapes, const World& mission_world,
                                             yaml::Violations& violations) {
  ChangeReader reader(keys, mission_world, violations);
  if (action == "add_obstacle") {
    auto shape = shapes.read_obstacle(keys, path, at);
    if (!shape) return std::nullopt;
    return AddObstacle{std::move(*shape)};
  }
  if (action == "move_obstacle") return reader.move();
  if (action == "remove_obstacle") return reader.remove();
  if (action == "goto") return reader.go_to(shapes);
  if (action == "risk") return reader.risk();
  if (action == "add_body") return reader.add_body(path, at, shapes);
  if (action == "clear") return reader.clear();
  return std::nullopt;
}

// Completes the abbreviations of the command line to a YAML mapping, then uses the reader of
// scripts.
Result<SceneChange> parse_scene_change(const std::string& action, const std::string& keys,
                                       const World& mission_world) {
  yaml::Violations violations;
  const std::size_t digits = keys.find_first_of("0123456789");
  if (action == "clear" && digits != std::string::npos &&
      keys.find_first_not_of(" 0123456789") == std::string::npos) {
    return parse_scene_change(action, "{robot: " + keys.substr(digits) + "}", mission_world);
  }
  const bool braced =
      keys.find_first_not_of(' ') != std::string::npos && keys[keys.find_first_not_of(' ')] == '{';
  const auto root = yaml::parse(braced ? keys : "{" + keys + "}");
  if (!root) {
    violations.add(root.error().at, root.error().what);
    return tl::unexpected(violations.to_error(action));
  }
  MapReader reader(*root, "", violations);
  ShapeReader shapes(violations);
  auto change =
      read_scene_change(action, reader, action, root->at, shapes, mission_world, violations);
  reader.finish();
  if (!violations.empty()) return tl::unexpected(violations.to_error(action));
  if (!change) return fail(ErrorCode::kBadInput, action + ": unknown");
  return *std::move(change);
}

std::string keys_of(const SceneChange& change) {
  return std::visit(
      Overloaded{[](const AddObstacle& c) { return keys_of_shape(c.shape); },
                 [](const MoveObstacle& c) {
                   return fmt::format("obstacle: {}, by_m: {}, over_s: {}", c.obstacle,
                                      yaml_point(c.by_m), c.over_s);
                 },
                 [](const RemoveObstacle& c) { return fmt::format("obstacle: {}", c.obstacle); },
                 [](const GoTo& c) { return keys_of_goal(c.goal); },
                 [](const SetRisk& c) { return fmt::format("alpha: {}", c.alpha); },
                 [](const AddBody& c) {
                   return fmt::format("robot: {}, {}", c.robot.value(), keys_of_shape(c.shape));
                 },
                 [](const ClearBody& c) { return fmt::format("robot: {}", c.robot.value()); }},
      change);
}

}  // namespace swarm
