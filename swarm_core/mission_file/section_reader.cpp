// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission_file/section_reader.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "swarmflow/mission/body_limits.hpp"

namespace swarm {

using yaml::MapReader;
using yaml::Node;
using yaml::Position;

namespace {

/// Options that no key set get the default of the first component that declares them.
void set_defaults(const Components& components, OptionValues& values) {
  for (const ComponentSpec& component : components) {
    for (const OptionSpec& option : component.options) {
      if (values.find(option.key) == nullptr) values.set(option.key, option.fallback);
    }
  }
}

}  // namespace

/// Remembers where a key was read, or that its value was wrong.
void SectionReader::keep_position(const std::string& path, const Node& value, bool good) {
  if (good) {
    positions_[path] = value.at;
  } else {
    bad_.insert(path);
  }
}

void SectionReader::read_planner(const Node* node, PlannerSpec& planner) {
  if (node != nullptr) {
    MapReader keys(*node, "planner", violations_);
    read_name(keys, "method", planning(), planner.method);
    read_automatic(keys, "density_cap_per_m2", reader_bounds::kDensityCap_per_m2,
                   planner.density_cap_per_m2);
    read_fields(keys, planner, kPlannerKeys);
    read_options(keys, planning(), planner.options);
    keys.finish();
  }
  set_defaults(catalogue_.planning_methods, planner.options);
}

void SectionReader::read_control(const Node* node, ControlSpec& control_spec) {
  if (node != nullptr) {
    MapReader keys(*node, "control", violations_);
    read_name(keys, "method", control(), control_spec.method);
    read_automatic(keys, "shape_tolerance_m2", reader_bounds::kShapeTolerance_m2,
                   control_spec.shape_tolerance_m2);
    read_fields(keys, control_spec, kControlKeys);
    read_options(keys, control(), control_spec.options);
    keys.finish();
  }
  set_defaults(catalogue_.control_methods, control_spec.options);
  set_shape_tolerance(control_spec);
}

/// The order matters: the common body and its defaults are complete before the groups copy it.
void SectionReader::read_robots(const Node* node, RobotsSpec& robots,
                                std::optional<std::uint32_t> count) {
  if (node != nullptr) {
    MapReader keys(*node, "robots", violations_);
    read_fields(keys, robots, kRobotsKeys);
    if (count) robots.count = *count;
    read_body(keys, robots);
    const Node* groups = keys.take("groups");
    keys.finish();
    set_defaults(catalogue_.drivers, robots.options);
    if (groups != nullptr) read_groups(*groups, robots, count.has_value());
  }
  if (count) robots.count = *count;
  // Without the key `robots` in the file this call alone sets the defaults.
  set_defaults(catalogue_.drivers, robots.options);
  set_lag(robots);
}

void SectionReader::read_groups(const Node& node, RobotsSpec& robots, bool counted) {
  const auto* items =
      yaml::read_list(node, "robots.groups", 0, reader_bounds::kMaxRobotGroups, violations_);
  if (items == nullptr) return;
  std::uint64_t grouped = 0;
  for (std::size_t i = 0; i < items->size(); ++i) {
    RobotGroupSpec group{robots, 0};  // keys that the group does not set are those of all robots
    MapReader keys((*items)[i], fmt::format("robots.groups[{}]", i), violations_);
    if (const Node* value = keys.take("count", true)) {
      group.count =
          yaml::read_count(*value, keys.path_of("count"), between(1, kMaxRobots), violations_)
              .value_or(0);
    }
    read_body(keys, group);
    keys.finish();
    set_lag(group);
    grouped += group.count;
    robots.groups.push_back(std::move(group));
  }
  if (grouped > robots.count) {
    violations_.add(node.at,
                    fmt::format("robots.groups have {} robots; must be <= robots.count "
                                "({}{})",
                                grouped, robots.count, counted ? ", set by --robots" : ""));
  }
}

void SectionReader::read_body(MapReader& keys, BodySpec& body) {
  read_name(keys, "model", drivers(), body.model);
  read_fields(keys, body, kBodyKeys);
  read_automatic(keys, "lag_s", reader_bounds::kLag_s, body.lag_s);
  read_options(keys, drivers(), body.options);
}

/// Fills in the lag that the driver declares. As a part of the resolved mission it is then known to
/// programs that do not have the driver.
void SectionReader::set_lag(BodySpec& body) const {
  const ComponentSpec* driver = find_component(catalogue_.drivers, body.model);
  if (driver != nullptr && !body.lag_s) body.lag_s = declared_lag_s(body, driver->lag);
}

/// Like set_lag(): the audit judges arrival by it and does not know the method.
void SectionReader::set_shape_tolerance(ControlSpec& control_spec) const {
  const ComponentSpec* method = find_component(catalogue_.control_methods, control_spec.method);
  if (method == nullptr || control_spec.shape_tolerance_m2) return;
  control_spec.shape_tolerance_m2 = control_spec.options.number(method->shape_tolerance);
}

/// A number, or `auto`, which leaves the value unset.
void SectionReader::read_automatic(MapReader& keys, std::string_view key, const Range& range,
                                   std::optional<double>& value) {
  const Node* node = keys.take(key);
  if (node == nullptr) return;
  if (node->kind == Node::Kind::kScalar && node->text == reader_bounds::kAutomatic) {
    value.reset();
  } else {
    value = yaml::read_number(*node, keys.path_of(key), range, violations_);
  }
}

/// In an open section any name is accepted, since the program does not know the components of
/// others.
void SectionReader::read_name(MapReader& keys, std::string_view key,
                              const ComponentSection& section, std::string& name) {
  const Node* node = keys.take(key);
  if (node == nullptr) return;
  std::vector<std::string_view> known;
  for (const ComponentSpec& component : section.components) known.emplace_back(component.name);
  auto chosen = section.is_open ? yaml::read_text(*node, keys.path_of(key), violations_)
                                : yaml::read_choice(*node, keys.path_of(key), known, violations_);
  if (chosen) name = *std::move(chosen);
}

/// The options that components of a section declare, whichever of them the mission names.
void SectionReader::read_options(MapReader& keys, const ComponentSection& section,
                                 OptionValues& values) {
  std::set<std::string_view> seen;  // a key that components share is read once
  for (const ComponentSpec& component : section.components) {
    for (const OptionSpec& option : component.options) {
      if (!seen.insert(option.key).second) continue;
      if (const Node* node = keys.take(option.key)) read_option(*node, keys, option, values);
    }
  }
  if (!section.is_open) return;
  for (const auto& [key, node] : keys.take_scalars()) values.set(key, node->text);
}

/// Numbers are stored as text, like choices, in the form that reads back to the same double.
void SectionReader::read_option(const Node& node, const MapReader& keys, const OptionSpec& option,
                                OptionValues& values) {
  const std::string path = keys.path_of(option.key);
  bool good = false;
  if (option.kind == OptionSpec::Kind::kChoice) {
    const std::vector<std::string_view> choices(option.choices.begin(), option.choices.end());
    const auto chosen = yaml::read_choice(node, path, choices, violations_);
    good = chosen.has_value();
    if (good) values.set(option.key, *chosen);
  } else if (option.kind == OptionSpec::Kind::kText) {
    const auto text = yaml::read_printable(node, path, kMaxOptionText, violations_);
    good = text.has_value();
    if (good) values.set(option.key, *text);
  } else if (option.kind == OptionSpec::Kind::kCount) {
    const auto count = yaml::read_count(node, path, option.range, violations_);
    good = count.has_value();
    if (good) values.set(option.key, static_cast<double>(*count));
  } else {
    const auto number = yaml::read_number(node, path, option.range, violations_);
    good = number.has_value();
    if (good) values.set(option.key, *number);
  }
  keep_position(path, node, good);
}

/// Rules between keys are checked after all sections are read: they tie keys of different sections.
void SectionReader::check_rules(const Mission& mission) {
  add(broken_rules(mission));
  add(broken_rules("planner", catalogue_.planning_methods, mission.planner.options));
  add(broken_rules("control", catalogue_.control_methods, mission.control.options));
  add(broken_rules("robots", catalogue_.drivers, mission.robots.options));
}

/// A rule with a key that is itself wrong is skipped, because its value was replaced by a default.
/// The message is placed at the first of its keys that the file sets.
void SectionReader::add(const std::vector<BrokenRule>& rules) {
  for (const BrokenRule& rule : rules) {
    const auto is_bad = [&](const std::string& key) { return bad_.contains(key); };
    if (std::any_of(rule.keys.begin(), rule.keys.end(), is_bad)) continue;
    const auto given =
        std::find_if(rule.keys.begin(), rule.keys.end(),
                     [&](const std::string& key) { return positions_.contains(key); });
    violations_.add(given == rule.keys.end() ? Position{} : positions_[*given], rule.message);
  }
}

}  // namespace swarm
