// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/mission/mission_file.hpp"

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

#include "swarm_core/mission/goal_shape.hpp"
#include "swarm_core/mission/mission_fields.hpp"
#include "swarm_core/mission/mission_rules.hpp"
#include "swarm_core/mission/scene_change_file.hpp"
#include "swarm_core/mission/yaml_reader.hpp"

namespace swarm {
namespace {

using mission_fields::Field;
using yaml::MapReader;
using yaml::Node;
using yaml::Position;

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
  MissionReader(const std::filesystem::path& directory, const Catalogue& catalogue,
                yaml::Violations& violations)
      : catalogue_(catalogue), violations_(violations), shapes_(violations, directory) {}

  Mission read(const Node& root) {
    MapReader top(root, "", violations_);
    read_version(top);
    if (const Node* node = top.take("name")) read_name(*node);
    if (const Node* node = top.take("robots")) read_robots(*node);
    if (const Node* node = top.take("world", true)) read_world(*node);
    mission_.start = read_mixture(top, "start");
    mission_.goal = read_mixture(top, "goal", &mission_.goal_shape);
    if (const Node* node = top.take("goal_shape")) read_drawing(*node);
    read_section(top, "planner", mission_.planner, mission_fields::kPlanner);
    read_section(top, "control", mission_.control, mission_fields::kControl);
    read_section(top, "safety", mission_.safety, mission_fields::kSafety);
    read_section(top, "link", mission_.link, mission_fields::kLink);
    read_section(top, "timing", mission_.timing, mission_fields::kTiming);
    read_section(top, "plan_clock", mission_.plan_clock, mission_fields::kPlanClock);
    read_section(top, "launcher", mission_.launcher, mission_fields::kLauncher);
    read_section(top, "criteria", mission_.criteria, mission_fields::kCriteria);
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
    if constexpr (std::is_same_v<Section, ControlSpec>) {
      read_component(keys, "method", control_section(), section.method);
      read_choice(keys, "tracking", mission_fields::kTracking, section.tracking);
    }
    if constexpr (std::is_same_v<Section, PlannerSpec>) {
      read_component(keys, "method", planner_section(), section.method);
      read_choice(keys, "sampler", mission_fields::kPlannerSamplers, section.sampler);
      read_choice(keys, "density_cap", mission_fields::kDensityCaps, section.density_cap);
      read_automatic(keys, "density_cap_per_m2", mission_fields::kDensityCap_per_m2,
                     section.density_cap_per_m2);
    }
    read_fields(keys, section, fields);
    if constexpr (std::is_same_v<Section, ControlSpec>) {
      read_options(keys, control_section(), section.options);
    }
    if constexpr (std::is_same_v<Section, PlannerSpec>) {
      read_options(keys, planner_section(), section.options);
    }
    keys.finish();
  }

  template <class Section, std::size_t N>
  void read_fields(MapReader& keys, Section& section, const std::array<Field<Section>, N>& fields) {
    for (const Field<Section>& field : fields) {
      if (const Node* value = keys.take(field.key)) read_field(*value, keys, field, section);
    }
  }

  void read_body(MapReader& keys, BodySpec& body) {
    read_component(keys, "model", drivers_section(), body.model);
    read_fields(keys, body, mission_fields::kBody);
    read_options(keys, drivers_section(), body.options);
  }

  void read_robots(const Node& node) {
    RobotsSpec& robots = mission_.robots;
    MapReader keys(node, "robots", violations_);
    read_fields(keys, robots, mission_fields::kRobots);
    read_body(keys, robots);
    const Node* groups = keys.take("groups");
    keys.finish();
    if (groups == nullptr) return;
    const auto* items =
        yaml::read_list(*groups, "robots.groups", 0, mission_fields::kMaxRobotGroups, violations_);
    if (items == nullptr) return;
    std::uint64_t grouped = 0;
    for (std::size_t i = 0; i < items->size(); ++i) {
      RobotGroupSpec group{robots, 0};  // what it does not say is as for the others
      MapReader keys_of_group((*items)[i], fmt::format("robots.groups[{}]", i), violations_);
      if (const Node* value = keys_of_group.take("count", true)) {
        group.count =
            yaml::read_count(*value, keys_of_group.path_of("count"),
                             mission_fields::between(1, mission_fields::kMaxRobots), violations_)
                .value_or(0);
      }
      read_body(keys_of_group, group);
      keys_of_group.finish();
      grouped += group.count;
      robots.groups.push_back(std::move(group));
    }
    if (grouped > robots.count) {
      violations_.add(groups->at,
                      fmt::format("robots.groups have {} robots; must be <= robots.count ({})",
                                  grouped, robots.count));
    }
  }

  template <class Section>
  void read_field(const Node& value, const MapReader& keys, const Field<Section>& field,
                  Section& section) {
    const std::string path = keys.path_of(field.key);
    const bool good = std::visit(
        [&](auto member) {
          using T = std::remove_reference_t<decltype(section.*member)>;
          if constexpr (std::is_same_v<T, std::uint32_t>) {
            const auto read = yaml::read_count(value, path, field.range, violations_);
            if (read) section.*member = *read;
            return read.has_value();
          } else {
            const auto read = yaml::read_number(value, path, field.range, violations_);
            if (read) section.*member = *read;
            return read.has_value();
          }
        },
        field.member);
    if (good) {
      places_[path] = value.at;
    } else {
      bad_.insert(path);
    }
  }

  /// A number, or `auto`, which leaves the value unset.
  void read_automatic(MapReader& keys, std::string_view key, const yaml::Range& range,
                      std::optional<double>& value) {
    const Node* node = keys.take(key);
    if (node == nullptr) return;
    if (node->kind == Node::Kind::kScalar && node->text == mission_fields::kAutomatic) {
      value.reset();
    } else {
      value = yaml::read_number(*node, keys.path_of(key), range, violations_);
    }
  }

  void read_choice(MapReader& keys, std::string_view key, std::span<const std::string_view> known,
                   std::string& choice) {
    const Node* node = keys.take(key);
    if (node == nullptr) return;
    auto chosen = yaml::read_choice(*node, keys.path_of(key), known, violations_);
    if (chosen) choice = *std::move(chosen);
  }

  /// The components that a section of the file may name.
  struct ComponentSection {
    std::span<const std::string_view> built_in;
    const Components& others;
    bool is_open = false;
  };
  ComponentSection control_section() const {
    return {mission_fields::kControlMethods, catalogue_.control_methods,
            catalogue_.robots_are_open};
  }
  ComponentSection planner_section() const {
    return {mission_fields::kPlannerMethods, catalogue_.planning_methods,
            catalogue_.planning_is_open};
  }
  ComponentSection drivers_section() const {
    return {mission_fields::kRobotModels, catalogue_.drivers, catalogue_.robots_are_open};
  }

  void read_component(MapReader& keys, std::string_view key, const ComponentSection& section,
                      std::string& name) {
    if (!section.is_open) {
      std::vector<std::string_view> known(section.built_in.begin(), section.built_in.end());
      for (const ComponentSpec& component : section.others) {
        if (std::find(known.begin(), known.end(), component.name) == known.end()) {
          known.emplace_back(component.name);
        }
      }
      return read_choice(keys, key, known, name);
    }
    const Node* node = keys.take(key);
    if (node == nullptr) return;
    if (auto text = yaml::read_text(*node, keys.path_of(key), violations_)) name = *text;
  }

  /// The options that components of a section declare, whichever of them the mission names.
  void read_options(MapReader& keys, const ComponentSection& section, OptionValues& values) {
    for (const ComponentSpec& component : section.others) {
      for (const OptionSpec& option : component.options) {
        if (const Node* node = keys.take(option.key)) read_option(*node, keys, option, values);
      }
    }
    if (!section.is_open) return;
    for (const auto& [key, node] : keys.take_scalars()) values.set(key, node->text);
  }

  void read_option(const Node& node, const MapReader& keys, const OptionSpec& option,
                   OptionValues& values) {
    const std::string path = keys.path_of(option.key);
    bool good = false;
    if (option.kind == OptionSpec::Kind::kChoice) {
      const std::vector<std::string_view> words(option.words.begin(), option.words.end());
      good = yaml::read_choice(node, path, words, violations_).has_value();
    } else if (option.kind == OptionSpec::Kind::kCount) {
      good = yaml::read_count(node, path, option.range, violations_).has_value();
    } else {
      good = yaml::read_number(node, path, option.range, violations_).has_value();
    }
    if (good) values.set(option.key, node.text);
  }

  void read_world(const Node& node) {
    MapReader keys(node, "world", violations_);
    std::optional<Box> bounds;
    if (const Node* value = keys.take("bounds_m", true)) bounds = shapes_.read_bounds(*value);
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

  std::vector<Obstacle> read_obstacles(const Node& node) {
    std::vector<Obstacle> obstacles;
    const auto* items =
        yaml::read_list(node, "world.obstacles", 0, mission_fields::kMaxObstacles, violations_);
    if (items == nullptr) return obstacles;
    for (std::size_t i = 0; i < items->size(); ++i) {
      const std::string path = fmt::format("world.obstacles[{}]", i);
      MapReader keys((*items)[i], path, violations_);
      if (auto shape = shapes_.read_obstacle(keys, path, (*items)[i].at)) {
        obstacles.push_back(std::move(*shape));
      }
      keys.finish();
    }
    return obstacles;
  }

  /// Of a resolved mission, whose goal is the mixture fitted to it.
  void read_drawing(const Node& node) {
    if (mission_.goal_shape != nullptr) {
      violations_.add(node.at,
                      "goal_shape stands beside a goal that is a shape itself; must be "
                      "left out, or beside a list of components");
      return;
    }
    mission_.goal_shape = read_shape_field(node, "goal_shape", violations_);
  }

  Mixture read_mixture(MapReader& top, const std::string& key,
                       std::shared_ptr<const ShapeField>* drawing = nullptr) {
    const Node* node = top.take(key, true);
    if (node == nullptr) return {};
    return shapes_
        .read_mixture(
            *node, key,
            {.world = has_world_ ? &mission_.world : nullptr, .radius_m = mission_.robots.radius_m},
            drawing)
        .value_or(Mixture{});
  }

  void read_script(const Node& node) {
    const auto* items =
        yaml::read_list(node, "script", 0, mission_fields::kMaxScriptEvents, violations_);
    if (items == nullptr) return;
    double previous_s = 0.0;
    Scene scene = first_scene(mission_.world.obstacles().size());
    for (std::size_t i = 0; i < items->size(); ++i) {
      const std::string path = fmt::format("script[{}]", i);
      MapReader keys((*items)[i], path, violations_);
      std::optional<double> at_s;
      if (const Node* value = keys.take("at_s", true)) {
        at_s = yaml::read_number(*value, keys.path_of("at_s"), mission_fields::kScriptTime_s,
                                 violations_);
        if (at_s && *at_s < previous_s) {
          violations_.add(value->at, fmt::format("{} is {}; must be >= the one before ({})",
                                                 keys.path_of("at_s"), *at_s, previous_s));
        }
        previous_s = at_s.value_or(previous_s);
      }
      const Node* word = keys.take("action", true);
      const auto name = word == nullptr
                            ? std::nullopt
                            : yaml::read_choice(*word, keys.path_of("action"),
                                                mission_fields::kScriptActions, violations_);
      if (!name) continue;  // which other keys belong here is not known
      const auto action = read_action(*name, keys, path, (*items)[i].at);
      keys.finish();
      if (!at_s || !action) continue;
      if (has_world_) follow_scene(scene, *action, *at_s, (*items)[i].at, path);
      mission_.script.push_back({.at_s = *at_s, .action = *action});
    }
  }

  /// Obstacles that a script moves or removes must be there by then. Which robots fall is not
  /// known: a script may clear any.
  void follow_scene(Scene& scene, const MissionAction& action, double at_s, Position at,
                    const std::string& path) {
    const auto* change = std::get_if<SceneChange>(&action);
    if (change == nullptr) return;
    if (const auto* clear = std::get_if<ClearBody>(change)) {
      if (clear->robot.value() < mission_.robots.count) return;
      violations_.add(at, fmt::format("{}: there is no robot {}", path, clear->robot.value()));
      return;
    }
    auto next = after(scene, *change, mission_.world, UtcTime(from_seconds(at_s)));
    if (next) {
      scene = std::move(*next);
    } else {
      violations_.add(at, fmt::format("{}: {}", path, next.error().message));
    }
  }

  std::optional<MissionAction> read_action(const std::string& name, MapReader& keys,
                                           const std::string& path, Position at) {
    for (const CommandKind kind : {CommandKind::kPause, CommandKind::kResume, CommandKind::kStop}) {
      if (name == to_string(kind)) return kind;
    }
    auto change = read_scene_change(name, keys, path, at, shapes_, mission_.world, violations_);
    if (!change) return std::nullopt;
    return *std::move(change);
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

  const Catalogue& catalogue_;
  yaml::Violations& violations_;
  Mission mission_;
  ShapeReader shapes_;
  bool has_world_ = false;
  std::map<std::string, Position> places_;  // of scalar keys, by path
  std::set<std::string> bad_;               // paths of scalar keys with a violation
};

}  // namespace

Result<Mission> parse_mission(std::string_view text, const std::string& name,
                              const std::filesystem::path& directory, const Catalogue& catalogue) {
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
  Mission mission = MissionReader(directory, catalogue, violations).read(*root);
  if (!violations.empty()) return tl::unexpected(violations.to_error(name));
  return mission;
}

Result<Mission> load_mission(const std::filesystem::path& file, const Catalogue& catalogue) {
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
  return parse_mission(text, file.filename().string(), file.parent_path(), catalogue);
}

}  // namespace swarm
