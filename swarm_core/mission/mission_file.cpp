// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission/mission_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "swarm_core/mission/mission_fields.hpp"
#include "swarm_core/mission/mission_rules.hpp"
#include "swarm_core/mission/yaml_reader.hpp"

namespace swarm {
namespace {

using mission_fields::Field;
using yaml::MapReader;
using yaml::Node;
using yaml::Position;
using yaml::Range;

constexpr Range kCoordinate_m =
    mission_fields::between(-mission_fields::kMaxExtent_m, mission_fields::kMaxExtent_m);
constexpr Range kVariance_m2 = mission_fields::between(-1e12, 1e12);
constexpr Range kWeight = mission_fields::positive(1);

/// The name becomes part of file names.
bool is_good_name(std::string_view name) {
  return !name.empty() && name.size() <= mission_fields::kMaxNameLength && name[0] != '.' &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  c == '_' || c == '-' || c == '.';
         });
}

class MissionReader {
 public:
  explicit MissionReader(yaml::Violations& violations) : violations_(violations) {}

  Mission read(const Node& root) {
    MapReader top(root, "", violations_);
    read_version(top);
    if (const Node* node = top.take("name")) read_name(*node);
    read_section(top, "robots", mission_.robots, mission_fields::kRobots);
    if (const Node* node = top.take("world", true)) read_world(*node);
    mission_.start = read_mixture(top, "start");
    mission_.goal = read_mixture(top, "goal");
    read_section(top, "planner", mission_.planner, mission_fields::kPlanner);
    read_section(top, "control", mission_.control, mission_fields::kControl);
    read_section(top, "safety", mission_.safety, mission_fields::kSafety);
    read_section(top, "link", mission_.link, mission_fields::kLink);
    read_section(top, "timing", mission_.timing, mission_fields::kTiming);
    read_section(top, "launcher", mission_.launcher, mission_fields::kLauncher);
    if (const Node* node = top.take("script")) read_script(*node);
    top.finish();
    if (top.is_map()) check_rules();
    return std::move(mission_);
  }

 private:
  void read_version(MapReader& top) {
    const Node* node = top.take("version", true);
    if (node == nullptr) return;
    yaml::read_count(*node, "version", mission_fields::between(1, 1), violations_);
  }

  void read_name(const Node& node) {
    const auto name = yaml::read_text(node, "name", violations_);
    if (!name) return;
    if (!is_good_name(*name)) {
      violations_.add(node.at, fmt::format("name is {}; must be 1 to {} letters, digits, _ - . "
                                           "and not begin with a dot",
                                           describe(node), mission_fields::kMaxNameLength));
      return;
    }
    mission_.name = *name;
  }

  template <class Section, std::size_t N>
  void read_section(MapReader& top, std::string_view key, Section& section,
                    const std::array<Field<Section>, N>& fields) {
    const Node* node = top.take(key);
    if (node == nullptr) return;
    MapReader keys(*node, std::string(key), violations_);
    if constexpr (std::is_same_v<Section, PlannerSpec>) {
      read_choice(keys, "method", mission_fields::kPlannerMethods, section.method);
      read_choice(keys, "sampler", mission_fields::kPlannerSamplers, section.sampler);
    }
    for (const Field<Section>& field : fields) {
      if (const Node* value = keys.take(field.key)) read_field(*value, keys, field, section);
    }
    keys.finish();
  }

  template <class Section>
  void read_field(const Node& value, const MapReader& keys, const Field<Section>& field,
                  Section& section) {
    const std::string path = keys.path_of(field.key);
    const bool good = std::visit(
        [&](auto member) {
          using T = std::remove_reference_t<decltype(section.*member)>;
          std::optional<T> read;
          if constexpr (std::is_same_v<T, double>) {
            read = yaml::read_number(value, path, field.range, violations_);
          } else {
            read = yaml::read_count(value, path, field.range, violations_);
          }
          if (read) section.*member = *read;
          return read.has_value();
        },
        field.member);
    if (good) {
      places_[path] = value.at;
    } else {
      bad_.insert(path);
    }
  }

  void read_choice(MapReader& keys, std::string_view key, std::span<const std::string_view> known,
                   std::string& choice) {
    const Node* node = keys.take(key);
    if (node == nullptr) return;
    auto chosen = yaml::read_choice(*node, keys.path_of(key), known, violations_);
    if (chosen) choice = *std::move(chosen);
  }

  void read_world(const Node& node) {
    MapReader keys(node, "world", violations_);
    std::optional<Box> bounds;
    if (const Node* value = keys.take("bounds_m", true)) bounds = read_bounds(*value);
    std::vector<Obstacle> obstacles;
    if (const Node* value = keys.take("obstacles")) obstacles = read_obstacles(*value);
    keys.finish();
    if (!bounds) return;
    auto world = World::make(*bounds, std::move(obstacles));
    if (!world) {
      violations_.add(node.at, fmt::format("world: {}", world.error().message));
      return;
    }
    mission_.world = std::move(*world);
    has_world_ = true;
  }

  std::optional<Box> read_bounds(const Node& node) {
    const auto b = yaml::read_numbers(node, "world.bounds_m", 4, kCoordinate_m, violations_);
    if (!b) return std::nullopt;
    if (!((*b)[0] < (*b)[2] && (*b)[1] < (*b)[3])) {
      violations_.add(node.at,
                      "world.bounds_m is empty; must be [x0, y0, x1, y1] with x0 < x1 and y0 < y1");
      return std::nullopt;
    }
    return Box{.min_m = {(*b)[0], (*b)[1]}, .max_m = {(*b)[2], (*b)[3]}};
  }

  std::vector<Obstacle> read_obstacles(const Node& node) {
    std::vector<Obstacle> obstacles;
    const auto* items =
        yaml::read_list(node, "world.obstacles", 0, mission_fields::kMaxObstacles, violations_);
    if (items == nullptr) return obstacles;
    for (std::size_t i = 0; i < items->size(); ++i) {
      const std::string path = fmt::format("world.obstacles[{}]", i);
      MapReader keys((*items)[i], path, violations_);
      const Node* polygon = keys.take("polygon_m");
      const Node* circle = keys.take("circle_m");
      keys.finish();
      if (keys.is_map() && (polygon == nullptr) == (circle == nullptr)) {
        violations_.add((*items)[i].at,
                        fmt::format("{} has {}; must have one of polygon_m and circle_m", path,
                                    polygon == nullptr ? "no shape" : "two shapes"));
        continue;
      }
      if (polygon != nullptr) read_polygon(*polygon, path + ".polygon_m", obstacles);
      if (circle != nullptr) read_circle(*circle, path + ".circle_m", obstacles);
    }
    return obstacles;
  }

  void read_polygon(const Node& node, const std::string& path, std::vector<Obstacle>& obstacles) {
    const auto* items = yaml::read_list(node, path, 3, Polygon::kMaxVertices, violations_);
    if (items == nullptr) return;
    vertices_ += items->size();
    if (vertices_ > mission_fields::kMaxVertices) {
      violations_.add(node.at, fmt::format("{}: {} vertices so far; must be <= {} in all polygons "
                                           "together",
                                           path, vertices_, mission_fields::kMaxVertices));
      return;
    }
    std::vector<Vec2> vertices;
    for (std::size_t i = 0; i < items->size(); ++i) {
      const auto p = yaml::read_numbers((*items)[i], fmt::format("{}[{}]", path, i), 2,
                                        kCoordinate_m, violations_);
      if (p) vertices.emplace_back((*p)[0], (*p)[1]);
    }
    if (vertices.size() != items->size()) return;
    auto polygon = Polygon::make(std::move(vertices));
    if (polygon) {
      obstacles.emplace_back(std::move(*polygon));
    } else {
      violations_.add(node.at, fmt::format("{}: {}", path, polygon.error().message));
    }
  }

  void read_circle(const Node& node, const std::string& path, std::vector<Obstacle>& obstacles) {
    MapReader keys(node, path, violations_);
    std::optional<std::vector<double>> center;
    std::optional<double> radius;
    if (const Node* value = keys.take("center", true)) {
      center = yaml::read_numbers(*value, keys.path_of("center"), 2, kCoordinate_m, violations_);
    }
    if (const Node* value = keys.take("radius", true)) {
      radius =
          yaml::read_number(*value, keys.path_of("radius"),
                            mission_fields::positive(mission_fields::kMaxExtent_m), violations_);
    }
    keys.finish();
    if (!center || !radius) return;
    obstacles.emplace_back(Circle{.center_m = {(*center)[0], (*center)[1]}, .radius_m = *radius});
  }

  Mixture read_mixture(MapReader& top, const std::string& key) {
    const Node* node = top.take(key, true);
    if (node == nullptr) return {};
    const auto* items = yaml::read_list(*node, key, 1, mission_fields::kMaxComponents, violations_);
    if (items == nullptr) return {};
    std::vector<WeightedGaussian> components;
    for (std::size_t i = 0; i < items->size(); ++i) {
      auto component = read_component((*items)[i], fmt::format("{}[{}]", key, i));
      if (component) components.push_back(std::move(*component));
    }
    if (components.size() != items->size()) return {};
    auto mixture = Mixture::make(std::move(components));
    if (!mixture) {
      violations_.add(node->at, fmt::format("{}: {}", key, mixture.error().message));
      return {};
    }
    return std::move(*mixture);
  }

  std::optional<WeightedGaussian> read_component(const Node& node, const std::string& path) {
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
    if (mean) check_mean(mean_node->at, path + ".mean_m", {(*mean)[0], (*mean)[1]});
    if (!mean || !covariance || !weight) return std::nullopt;
    auto gaussian = Gaussian::make({(*mean)[0], (*mean)[1]}, *covariance);
    if (!gaussian) {
      violations_.add(covariance_node->at,
                      fmt::format("{}.covariance_m2: {}", path, gaussian.error().message));
      return std::nullopt;
    }
    return WeightedGaussian{.weight = *weight, .gaussian = *gaussian};
  }

  std::optional<Mat2> read_covariance(const Node& node, const std::string& path) {
    const auto* rows = yaml::read_list(node, path, 2, 2, violations_);
    if (rows == nullptr) return std::nullopt;
    const auto row0 = yaml::read_numbers((*rows)[0], path + "[0]", 2, kVariance_m2, violations_);
    const auto row1 = yaml::read_numbers((*rows)[1], path + "[1]", 2, kVariance_m2, violations_);
    if (!row0 || !row1) return std::nullopt;
    Mat2 covariance;
    covariance << (*row0)[0], (*row0)[1], (*row1)[0], (*row1)[1];
    return covariance;
  }

  void check_mean(Position at, const std::string& path, const Vec2& mean) {
    if (!has_world_) return;
    const std::string is = fmt::format("{} is ({}, {})", path, mean.x(), mean.y());
    if (!mission_.world.bounds_m().contains(mean)) {
      violations_.add(at, is + ", outside the world; must lie within world.bounds_m");
      return;
    }
    const double distance_m = mission_.world.distance_m(mean);
    if (distance_m >= mission_.robots.radius_m) return;
    violations_.add(at, distance_m < 0.0
                            ? is + ", inside an obstacle; must be free"
                            : fmt::format("{}, {:.3g} m from an obstacle; must be at least "
                                          "robots.radius_m ({})",
                                          is, distance_m, mission_.robots.radius_m));
  }

  void read_script(const Node& node) {
    const auto* items =
        yaml::read_list(node, "script", 0, mission_fields::kMaxScriptEvents, violations_);
    if (items == nullptr) return;
    double previous_s = 0.0;
    for (std::size_t i = 0; i < items->size(); ++i) {
      MapReader keys((*items)[i], fmt::format("script[{}]", i), violations_);
      std::optional<double> at_s;
      std::optional<ScriptAction> action;
      if (const Node* value = keys.take("at_s", true)) {
        at_s = yaml::read_number(*value, keys.path_of("at_s"), mission_fields::kScriptTime_s,
                                 violations_);
        if (at_s && *at_s < previous_s) {
          violations_.add(value->at, fmt::format("{} is {}; must be >= the one before ({})",
                                                 keys.path_of("at_s"), *at_s, previous_s));
        }
        previous_s = at_s.value_or(previous_s);
      }
      if (const Node* value = keys.take("action", true)) action = read_action(*value, keys);
      keys.finish();
      if (at_s && action) mission_.script.push_back({.at_s = *at_s, .action = *action});
    }
  }

  std::optional<ScriptAction> read_action(const Node& node, const MapReader& keys) {
    const std::string path = keys.path_of("action");
    const auto word = yaml::read_text(node, path, violations_);
    if (!word) return std::nullopt;
    for (const auto& [name, action] : mission_fields::kScriptActions) {
      if (*word == name) return action;
    }
    violations_.add(node.at,
                    fmt::format("{} is {}; must be pause, resume or stop", path, describe(node)));
    return std::nullopt;
  }

  /// A rule is shown where one of its keys is given; a rule whose key is broken by itself waits.
  void check_rules() {
    for (const BrokenRule& rule : broken_rules(mission_)) {
      const auto is_bad = [&](std::string_view key) { return bad_.contains(std::string(key)); };
      if (std::any_of(rule.keys.begin(), rule.keys.end(), is_bad)) continue;
      const auto given = std::find_if(rule.keys.begin(), rule.keys.end(),
                                      [&](auto key) { return places_.contains(std::string(key)); });
      const Position at = given == rule.keys.end() ? Position{} : places_[std::string(*given)];
      violations_.add(at, rule.message);
    }
  }

  yaml::Violations& violations_;
  Mission mission_;
  bool has_world_ = false;
  std::size_t vertices_ = 0;
  std::map<std::string, Position> places_;  // of scalar keys, by path
  std::set<std::string> bad_;               // paths of scalar keys with a violation
};

}  // namespace

Result<Mission> parse_mission(std::string_view text, const std::string& name) {
  if (text.size() > kMaxMissionBytes) {
    return fail(ErrorCode::kBadInput, fmt::format("{}:1:1: {} bytes; must be <= {}", name,
                                                  text.size(), kMaxMissionBytes));
  }
  yaml::Violations violations;
  const auto root = yaml::parse(text);
  if (!root) {
    violations.add(root.error().at, root.error().what);
    return tl::unexpected(violations.to_error(name));
  }
  Mission mission = MissionReader(violations).read(*root);
  if (!violations.empty()) return tl::unexpected(violations.to_error(name));
  return mission;
}

Result<Mission> load_mission(const std::filesystem::path& file) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"),
                                                               &std::fclose);
  if (!stream) {
    return fail(ErrorCode::kBadInput,
                fmt::format("{}: cannot be opened; is the path right?", file.string()));
  }
  // In pieces: making room for the largest mission allowed took half of an agent's start-up. One
  // byte more than allowed tells a file that is too large, without trusting its size.
  std::string text;
  std::array<char, 16'384> piece;
  while (text.size() <= kMaxMissionBytes) {
    const std::size_t read = std::fread(piece.data(), 1, piece.size(), stream.get());
    if (read == 0) break;
    text.append(piece.data(), read);
  }
  if (std::ferror(stream.get()) != 0) {
    return fail(ErrorCode::kBadInput,
                fmt::format("{}: cannot be read; is it a file?", file.string()));
  }
  return parse_mission(text, file.filename().string());
}

}  // namespace swarm
