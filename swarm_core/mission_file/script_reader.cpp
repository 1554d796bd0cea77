// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission_file/script_reader.hpp"

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/mission/goal_room.hpp"
#include "swarm_core/mission_file/reader_bounds.hpp"
#include "swarm_core/mission_file/scene_change_file.hpp"

namespace swarm {
namespace {

using yaml::MapReader;
using yaml::Node;
using yaml::Position;

/// Values of `action` in a script: commands first, then changes of the scene.
constexpr std::array<std::string_view, 9> kScriptActions{
    "pause",           "resume", "stop", "add_obstacle", "move_obstacle",
    "remove_obstacle", "goto",   "risk", "clear"};

// Reads events in order and applies their changes to a scene, which shows whether each of them is
// possible at its time.
class ScriptReader {
 public:
  ScriptReader(const ScriptContext& context, ShapeReader& shapes, yaml::Violations& violations)
      : context_(context),
        world_(context.world == nullptr ? World{} : *context.world),
        shapes_(shapes),
        violations_(violations),
        scene_(first_scene(world_.obstacles().size())) {}

  /// Empty after a violation.
  std::optional<ScriptEvent> read(const Node& item, const std::string& path) {
    MapReader keys(item, path, violations_);
    const std::optional<double> at_s = read_time(keys);
    const Node* node = keys.take("action", true);
    const auto name = node == nullptr ? std::nullopt
                                      : yaml::read_choice(*node, keys.path_of("action"),
                                                          kScriptActions, violations_);
    if (!name) return std::nullopt;  // the other keys depend on the action
    const auto action = read_action(*name, keys, path, item.at);
    keys.finish();
    if (!at_s || !action) return std::nullopt;
    if (context_.world != nullptr) follow_scene(*action, *at_s, item.at, path);
    return ScriptEvent{.at_s = *at_s, .action = *action};
  }

 private:
  // A time out of order still becomes the previous one, so that one misplaced event gives one
  // message.
  std::optional<double> read_time(MapReader& keys) {
    const Node* node = keys.take("at_s", true);
    if (node == nullptr) return std::nullopt;
    const auto at_s =
        yaml::read_number(*node, keys.path_of("at_s"), reader_bounds::kScriptTime_s, violations_);
    if (at_s && *at_s < previous_s_) {
      violations_.add(node->at, fmt::format("{} is {}; must be >= the one before ({})",
                                            keys.path_of("at_s"), *at_s, previous_s_));
    }
    previous_s_ = at_s.value_or(previous_s_);
    return at_s;
  }

  // A command has no keys but its name; every other action is a change of the scene.
  std::optional<MissionAction> read_action(const std::string& name, MapReader& keys,
                                           const std::string& path, Position at) {
    for (const CommandKind kind : {CommandKind::kPause, CommandKind::kResume, CommandKind::kStop}) {
      if (name == to_string(kind)) return kind;
    }
    auto change = read_scene_change(name, keys, path, at, shapes_, world_, violations_);
    if (!change) return std::nullopt;
    return *std::move(change);
  }

  /// Obstacles that a script moves or removes must exist at that time. Which robots will fall is
  /// not known, so a script may clear the body of any robot.
  void follow_scene(const MissionAction& action, double at_s, Position at,
                    const std::string& path) {
    const auto* change = std::get_if<SceneChange>(&action);
    if (change == nullptr) return;
    if (const auto* clear = std::get_if<ClearBody>(change)) {
      if (clear->robot.value() < context_.robots) return;
      violations_.add(at, fmt::format("{}: there is no robot {}", path, clear->robot.value()));
      return;
    }
    if (const auto* add = std::get_if<AddObstacle>(change)) {
      if (const auto lack = lack_of_place(add->shape, world_.bounds_m())) {
        violations_.add(at, fmt::format("{}: {}", path, *lack));
      }
    }
    auto next = after(scene_, *change, world_, UtcTime(from_seconds(at_s)));
    if (next) {
      scene_ = std::move(*next);
    } else {
      violations_.add(at, fmt::format("{}: {}", path, next.error().message));
    }
  }

  const ScriptContext context_;
  const World world_;
  ShapeReader& shapes_;
  yaml::Violations& violations_;
  Scene scene_;
  double previous_s_ = 0.0;
};

}  // namespace

std::vector<ScriptEvent> read_script(const Node& node, const ScriptContext& context,
                                     ShapeReader& shapes, yaml::Violations& violations) {
  std::vector<ScriptEvent> script;
  const auto* items =
      yaml::read_list(node, "script", 0, reader_bounds::kMaxScriptEvents, violations);
  if (items == nullptr) return script;
  ScriptReader reader(context, shapes, violations);
  for (std::size_t i = 0; i < items->size(); ++i) {
    auto event = reader.read((*items)[i], fmt::format("script[{}]", i));
    if (event) script.push_back(*std::move(event));
  }
  return script;
}

}  // namespace swarm
