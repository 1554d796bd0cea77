// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/mission/mission_file.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/mission_file/goal_shape.hpp"
#include "swarm_core/mission_file/mission_shapes.hpp"
#include "swarm_core/mission_file/reader_bounds.hpp"
#include "swarm_core/mission_file/script_reader.hpp"
#include "swarm_core/mission_file/section_reader.hpp"
#include "swarm_core/mission_file/yaml_reader.hpp"
#include "swarmflow/mission/section_key.hpp"

namespace swarm {
namespace {

using yaml::MapReader;
using yaml::Node;

/// The name becomes part of file names.
bool is_good_name(std::string_view name) {
  return !name.empty() && name.size() <= reader_bounds::kMaxNameLength && name[0] != '.' &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  c == '_' || c == '-' || c == '.';
         });
}

class MissionReader {
 public:
  MissionReader(const std::filesystem::path& directory, const Catalogue& catalogue,
                std::optional<std::uint32_t> robots, yaml::Violations& violations)
      : robots_(robots),
        violations_(violations),
        shapes_(violations, directory),
        sections_(catalogue, violations) {}

  // The order matters: robots come before the mixtures, whose means must clear obstacles by a
  // robot's radius, and the world comes before mixtures and script. Rules between keys come last.
  Mission read(const Node& root) {
    MapReader top(root, "", violations_);
    read_version(top);
    if (const Node* node = top.take("name")) read_name(*node);
    sections_.read_robots(top.take("robots"), mission_.robots, robots_);
    if (const Node* node = top.take("world", true)) read_world(*node);
    mission_.start = read_mixture(top, "start");
    mission_.goal = read_mixture(top, "goal", &mission_.goal_shape);
    if (const Node* node = top.take("goal_shape")) read_drawing(*node);
    sections_.read_planner(top.take("planner"), mission_.planner);
    sections_.read_control(top.take("control"), mission_.control);
    read_section(top, "safety", mission_.safety, kSafetyKeys);
    read_section(top, "link", mission_.link, kLinkKeys);
    read_section(top, "timing", mission_.timing, kTimingKeys);
    read_section(top, "plan_clock", mission_.plan_clock, kPlanClockKeys);
    read_section(top, "launcher", mission_.launcher, kLauncherKeys);
    read_section(top, "criteria", mission_.criteria, kCriteriaKeys);
    if (const Node* node = top.take("script")) {
      mission_.script = read_script(
          *node, {.world = has_world_ ? &mission_.world : nullptr, .robots = mission_.robots.count},
          shapes_, violations_);
    }
    top.finish();
    if (top.is_map()) sections_.check_rules(mission_);
    return std::move(mission_);
  }

 private:
  // Version 1 is the only one.
  void read_version(MapReader& top) {
    const Node* node = top.take("version", true);
    if (node == nullptr) return;
    yaml::read_count(*node, "version", between(1, 1), violations_);
  }

  void read_name(const Node& node) {
    const auto name = yaml::read_text(node, "name", violations_);
    if (!name) return;
    if (!is_good_name(*name)) {
      violations_.add(node.at, fmt::format("name is {}; must be 1 to {} letters, digits, _ - . "
                                           "and not begin with a dot",
                                           describe(node), reader_bounds::kMaxNameLength));
      return;
    }
    mission_.name = *name;
  }

  template <class Section, std::size_t N>
  void read_section(MapReader& top, const std::string& name, Section& section,
                    const std::array<SectionKey<Section>, N>& fields) {
    sections_.read(top.take(name), name, section, fields);
  }

  // Without a valid world the checks of positions against it are skipped instead of failing at
  // every mean.
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
        yaml::read_list(node, "world.obstacles", 0, reader_bounds::kMaxObstacles, violations_);
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

  /// The drawing of a resolved mission, whose goal is the mixture that was fitted to it.
  void read_drawing(const Node& node) {
    if (mission_.goal_shape != nullptr) {
      violations_.add(node.at,
                      "goal_shape stands beside a goal that is a shape itself; must be "
                      "left out, or beside a list of components");
      return;
    }
    mission_.goal_shape = read_shape_field(node, "goal_shape", violations_);
  }

  // An empty mixture stands for a violation, which is reported; the mission is then not returned.
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

  std::optional<std::uint32_t> robots_;
  yaml::Violations& violations_;
  Mission mission_;
  ShapeReader shapes_;
  SectionReader sections_;
  bool has_world_ = false;
};

}  // namespace

/// Syntax errors end the reading at once, as the tree behind them is unknown; all other violations
/// are collected and returned together, in order of the file.
Result<Mission> parse_mission(std::string_view text, const std::string& name,
                              const std::filesystem::path& directory, const Catalogue& catalogue,
                              std::optional<std::uint32_t> robots) {
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
  Mission mission = MissionReader(directory, catalogue, robots, violations).read(*root);
  if (!violations.empty()) return tl::unexpected(violations.to_error(name));
  return mission;
}

Result<Mission> load_mission(const std::filesystem::path& file, const Catalogue& catalogue,
                             std::optional<std::uint32_t> robots) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"),
                                                               &std::fclose);
  if (!stream) {
    return fail(ErrorCode::kBadInput,
                fmt::format("{}: cannot be opened; is the path right?", file.string()));
  }
  // In pieces: allocating room for the largest mission took half of an agent's start-up time. A
  // file that is too large shows by more bytes than allowed; its reported size is not trusted.
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
  return parse_mission(text, file.filename().string(), file.parent_path(), catalogue, robots);
}

}  // namespace swarm
