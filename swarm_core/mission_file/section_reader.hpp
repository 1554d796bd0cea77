// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "swarm_core/mission/mission_rules.hpp"
#include "swarm_core/mission_file/yaml_reader.hpp"
#include "swarmflow/mission/catalogue.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/mission/section_key.hpp"

namespace swarm {

/// Reads the sections of a mission file that are scalar keys: those of the mission's own tables
/// (include/swarmflow/mission/sections), and the names and keys of components, from the catalogue.
/// It remembers the position of each key in the file, for the messages of rules between keys.
class SectionReader {
 public:
  /// Both outlive it.
  SectionReader(const Catalogue& catalogue, yaml::Violations& violations)
      : catalogue_(catalogue), violations_(violations) {}

  /// A section without components. A null node is a section that the file leaves out.
  template <class Section, std::size_t N>
  void read(const yaml::Node* node, const std::string& name, Section& section,
            const std::array<SectionKey<Section>, N>& fields) {
    if (node == nullptr) return;
    yaml::MapReader keys(*node, name, violations_);
    read_fields(keys, section, fields);
    keys.finish();
  }

  // The sections of components; where the file leaves a key out, its default is set.
  void read_planner(const yaml::Node* node, PlannerSpec& planner);
  void read_control(const yaml::Node* node, ControlSpec& control);
  /// `count` replaces the number of robots in the file, before it is compared with the groups.
  void read_robots(const yaml::Node* node, RobotsSpec& robots, std::optional<std::uint32_t> count);

  /// Adds the rules that the mission violates. A violation is placed at a key of the rule that the
  /// file sets; a rule is skipped while one of its keys has a wrong value of its own.
  void check_rules(const Mission& mission);

 private:
  /// The components that a section of the file may name.
  struct ComponentSection {
    const Components& components;
    bool is_open = false;
  };
  ComponentSection planning() const {
    return {catalogue_.planning_methods, catalogue_.planning_is_open};
  }
  ComponentSection control() const {
    return {catalogue_.control_methods, catalogue_.robots_are_open};
  }
  ComponentSection drivers() const { return {catalogue_.drivers, catalogue_.robots_are_open}; }

  /// Reads the keys of a table that the file sets; the others keep their defaults.
  template <class Section, std::size_t N>
  void read_fields(yaml::MapReader& keys, Section& section,
                   const std::array<SectionKey<Section>, N>& fields) {
    for (const auto& field : fields) {
      if (const yaml::Node* value = keys.take(field.key)) read_field(*value, keys, field, section);
    }
  }

  /// Reads one key by the type of its member and remembers where it stands.
  template <class Section>
  void read_field(const yaml::Node& value, const yaml::MapReader& keys,
                  const SectionKey<Section>& field, Section& section) {
    const std::string path = keys.path_of(field.key);
    const bool good = std::visit(
        [&](auto member) {
          using T = std::remove_reference_t<decltype(section.*member)>;
          if constexpr (std::is_same_v<T, std::uint32_t>) {
            const auto read = yaml::read_count(value, path, field.range, violations_);
            if (read) section.*member = *read;
            return read.has_value();
          } else if constexpr (std::is_same_v<T, LauncherLoss>) {
            const auto read = yaml::read_choice(value, path, kLauncherLosses, violations_);
            if (read) section.*member = *launcher_loss_of(*read);
            return read.has_value();
          } else {
            const auto read = yaml::read_number(value, path, field.range, violations_);
            if (read) section.*member = *read;
            return read.has_value();
          }
        },
        field.member);
    keep_position(path, value, good);
  }

  void keep_position(const std::string& path, const yaml::Node& value, bool good);
  void read_body(yaml::MapReader& keys, BodySpec& body);
  void read_groups(const yaml::Node& node, RobotsSpec& robots, bool counted);
  void set_lag(BodySpec& body) const;
  void set_shape_tolerance(ControlSpec& control_spec) const;
  void read_automatic(yaml::MapReader& keys, std::string_view key, const Range& range,
                      std::optional<double>& value);
  void read_name(yaml::MapReader& keys, std::string_view key, const ComponentSection& section,
                 std::string& name);
  void read_options(yaml::MapReader& keys, const ComponentSection& section, OptionValues& values);
  void read_option(const yaml::Node& node, const yaml::MapReader& keys, const OptionSpec& option,
                   OptionValues& values);
  void add(const std::vector<BrokenRule>& rules);

  const Catalogue& catalogue_;
  yaml::Violations& violations_;
  std::map<std::string, yaml::Position> positions_;  // of scalar keys, by path
  std::set<std::string> bad_;                        // paths of scalar keys with a violation
};

}  // namespace swarm
