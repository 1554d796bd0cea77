// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/mission_file/reader_bounds.hpp"
#include "swarm_core/mission_file/scene_change_file.hpp"
#include "swarm_core/mission_file/yaml_point.hpp"
#include "swarmflow/mission/mission_file.hpp"
#include "swarmflow/mission/section_key.hpp"

namespace swarm {
namespace {

using Out = std::back_insert_iterator<std::string>;

// fmt's `{}` writes the shortest decimal that reads back to the same double.

/// Two levels of indentation: the obstacle is an item of the list in the section `world`.
void write_obstacle(Out out, const Obstacle& obstacle) {
  if (const auto* circle = std::get_if<Circle>(&obstacle)) {
    fmt::format_to(out, "    - circle_m: {{center: {}, radius: {}}}\n",
                   yaml_point(circle->center_m), circle->radius_m);
    return;
  }
  fmt::format_to(out, "    - polygon_m:\n");
  for (const Vec2& vertex : std::get<Polygon>(obstacle).vertices_m()) {
    fmt::format_to(out, "        - {}\n", yaml_point(vertex));
  }
}

void write_world(Out out, const World& world) {
  const Box& bounds = world.bounds_m();
  fmt::format_to(out, "world:\n  bounds_m: [{}, {}, {}, {}]\n", bounds.min_m.x(), bounds.min_m.y(),
                 bounds.max_m.x(), bounds.max_m.y());
  if (world.obstacles().empty()) return;
  fmt::format_to(out, "  obstacles:\n");
  for (const Obstacle& obstacle : world.obstacles()) write_obstacle(out, obstacle);
}

/// Covariances are written as full matrices, as the reader requires.
void write_mixture(Out out, std::string_view key, const Mixture& mixture) {
  fmt::format_to(out, "{}:\n", key);
  for (const auto& [weight, gaussian] : mixture.components()) {
    const Mat2& c = gaussian.covariance_m2();
    fmt::format_to(out, "  - mean_m: {}\n    covariance_m2: [[{}, {}], [{}, {}]]\n    weight: {}\n",
                   yaml_point(gaussian.mean_m()), c(0, 0), c(0, 1), c(1, 0), c(1, 1), weight);
  }
}

void write_shape(Out out, const ShapeField& shape) {
  fmt::format_to(out, "goal_shape:\n");
  if (!shape.polygons().empty()) fmt::format_to(out, "  polygons_m:\n");
  for (const Polygon& polygon : shape.polygons()) {
    std::string_view before = "    - [";
    for (const Vec2& vertex : polygon.vertices_m()) {
      fmt::format_to(out, "{}{}", std::exchange(before, ", "), yaml_point(vertex));
    }
    fmt::format_to(out, "]\n");
  }
  if (!shape.boxes_m().empty()) fmt::format_to(out, "  boxes_m:\n");
  for (const Box& box : shape.boxes_m()) {
    fmt::format_to(out, "    - [{}, {}, {}, {}]\n", box.min_m.x(), box.min_m.y(), box.max_m.x(),
                   box.max_m.y());
  }
}

/// Writes the members by the same tables that the reader uses, so no key can be forgotten on one
/// side. An optional number is written only where it is set.
template <class Section, std::size_t N>
void write_fields(Out out, const Section& section,
                  const std::array<SectionKey<Section>, N>& fields) {
  for (const auto& field : fields) {
    const auto write = [&](const auto& value) {
      fmt::format_to(out, "  {}: {}\n", field.key, value);
    };
    std::visit(
        [&](auto member) {
          if constexpr (requires { (section.*member).has_value(); }) {
            if (section.*member) write(*(section.*member));
          } else if constexpr (requires { to_string(section.*member); }) {
            write(to_string(section.*member));
          } else {
            write(section.*member);
          }
        },
        field.member);
  }
}

std::string or_automatic(const std::optional<double>& value) {
  return value ? fmt::format("{}", *value) : std::string(reader_bounds::kAutomatic);
}

/// A value of an option: numbers and plain names as they are, other texts in quotes.
std::string option_text(const std::string& text) {
  const auto is_alphanumeric = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0;
  };
  const auto is_plain = [&](char c) {
    return is_alphanumeric(c) || c == '_' || c == '.' || c == '+' || c == '-';
  };
  // YAML takes `null`, in three spellings, for no value.
  const bool is_null = text.size() == 4 && (text.ends_with("ull") || text == "NULL");
  const bool is_name =
      std::ranges::all_of(text, is_plain) && std::ranges::any_of(text, is_alphanumeric) && !is_null;
  return is_name ? text : fmt::format("\"{}\"", text);
}

/// The values of a component's own options, as checked when they were read.
void write_options(Out out, const OptionValues& options) {
  for (const auto& [key, text] : options.all()) {
    fmt::format_to(out, "  {}: {}\n", key, option_text(text));
  }
}

/// None of its keys need be set, but a section must not be empty: then it is left out.
void write_criteria(Out out, const CriteriaSpec& criteria) {
  std::string keys;
  write_fields(Out(keys), criteria, kCriteriaKeys);
  if (!keys.empty()) fmt::format_to(out, "criteria:\n{}", keys);
}

/// A group is written with all keys of its body, including those that it inherits: the resolved
/// file does not depend on the order of the keys.
void write_robots(Out out, const RobotsSpec& robots) {
  fmt::format_to(out, "robots:\n  model: {}\n  lag_s: {}\n", robots.model,
                 or_automatic(robots.lag_s));
  write_fields(out, robots, kRobotsKeys);
  write_fields<BodySpec>(out, robots, kBodyKeys);
  write_options(out, robots.options);
  if (robots.groups.empty()) return;
  fmt::format_to(out, "  groups:\n");
  for (const RobotGroupSpec& group : robots.groups) {
    fmt::format_to(out, "    - {{count: {}, model: {}, lag_s: {}", group.count, group.model,
                   or_automatic(group.lag_s));
    for (const auto& field : kBodyKeys) {
      fmt::format_to(
          out, ", {}: {}", field.key,
          static_cast<const BodySpec&>(group).*std::get<double BodySpec::*>(field.member));
    }
    for (const auto& [key, text] : group.options.all()) {
      fmt::format_to(out, ", {}: {}", key, option_text(text));
    }
    fmt::format_to(out, "}}\n");
  }
}

void write_script(Out out, const std::vector<ScriptEvent>& script) {
  if (script.empty()) return;
  fmt::format_to(out, "script:\n");
  for (const ScriptEvent& event : script) {
    if (const auto* kind = std::get_if<CommandKind>(&event.action)) {
      fmt::format_to(out, "  - {{at_s: {}, action: {}}}\n", event.at_s, to_string(*kind));
    } else {
      const auto& change = std::get<SceneChange>(event.action);
      fmt::format_to(out, "  - {{at_s: {}, action: {}, {}}}\n", event.at_s, name_of(change),
                     keys_of(change));
    }
  }
}

}  // namespace

/// Every key is written, defaults included: a resolved mission means the same to a later version
/// with other defaults.
std::string to_yaml(const Mission& mission) {
  std::string text;
  const Out out(text);
  fmt::format_to(out, "version: 1\nname: \"{}\"\n", mission.name);
  write_world(out, mission.world);
  write_robots(out, mission.robots);
  write_mixture(out, "start", mission.start);
  write_mixture(out, "goal", mission.goal);
  if (mission.goal_shape) write_shape(out, *mission.goal_shape);
  fmt::format_to(out, "planner:\n  method: {}\n  density_cap_per_m2: {}\n", mission.planner.method,
                 or_automatic(mission.planner.density_cap_per_m2));
  write_fields(out, mission.planner, kPlannerKeys);
  write_options(out, mission.planner.options);
  fmt::format_to(out, "control:\n  method: {}\n  shape_tolerance_m2: {}\n", mission.control.method,
                 or_automatic(mission.control.shape_tolerance_m2));
  write_fields(out, mission.control, kControlKeys);
  write_options(out, mission.control.options);
  fmt::format_to(out, "safety:\n");
  write_fields(out, mission.safety, kSafetyKeys);
  fmt::format_to(out, "link:\n");
  write_fields(out, mission.link, kLinkKeys);
  fmt::format_to(out, "timing:\n");
  write_fields(out, mission.timing, kTimingKeys);
  fmt::format_to(out, "plan_clock:\n");
  write_fields(out, mission.plan_clock, kPlanClockKeys);
  fmt::format_to(out, "launcher:\n");
  write_fields(out, mission.launcher, kLauncherKeys);
  write_criteria(out, mission.criteria);
  write_script(out, mission.script);
  return text;
}

}  // namespace swarm
