// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission_file/scene_log.hpp"

#include <utility>

#include <nlohmann/json.hpp>

#include "swarm_core/mission_file/scene_change_file.hpp"

namespace swarm {

// The scene's version is the time of the change in nanoseconds.
std::string scene_log_line(std::uint64_t version, const SceneChange& change) {
  const nlohmann::ordered_json line = {
      {"utc_ns", version}, {"action", name_of(change)}, {"keys", keys_of(change)}};
  return line.dump() + "\n";
}

// Applies the changes one by one. The last line may be cut if the launcher was killed: only lines
// that end with a newline are read. A line that a full disk cut is followed by the whole one.
std::vector<Scene> replay_scene_log(std::string_view text, const World& mission_world) {
  std::vector<Scene> scenes{first_scene(mission_world.obstacles().size())};
  for (std::size_t end = 0; (end = text.find('\n')) != std::string_view::npos;
       text.remove_prefix(end + 1)) {
    const auto line = nlohmann::json::parse(text.substr(0, end), nullptr, false);
    if (line.is_discarded()) continue;
    const auto is = [&](const char* key, auto test) {
      return line.is_object() && line.contains(key) && test(line[key]);
    };
    const auto text_like = [](const nlohmann::json& value) { return value.is_string(); };
    const auto stamp_like = [](const nlohmann::json& value) {
      return value.is_number_unsigned() && value.get<std::uint64_t>() <= INT64_MAX;
    };
    if (!is("action", text_like) || !is("keys", text_like) || !is("utc_ns", stamp_like)) break;
    const auto change = parse_scene_change(line["action"].get<std::string>(),
                                           line["keys"].get<std::string>(), mission_world);
    if (!change) break;
    const UtcTime at(Duration(line["utc_ns"].get<std::int64_t>()));
    auto next = after(scenes.back(), *change, mission_world, at);
    if (!next) break;
    scenes.push_back(std::move(*next));
  }
  return scenes;
}

}  // namespace swarm
