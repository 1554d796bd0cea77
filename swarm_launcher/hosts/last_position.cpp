// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/hosts/last_position.hpp"

#include <chrono>
#include <cmath>
#include <cstdint>

#include <nlohmann/json.hpp>

#include "swarm_core/base/clock.hpp"
#include "swarm_core/robot_log/robot_log_file.hpp"

namespace swarm::launcher {
namespace {

// The robot of a process that has just died or fallen silent made its last step within this time.
constexpr Duration kRecent = std::chrono::seconds(60);

// As in scenes and states: a body beyond it would make all robots refuse the scene.
constexpr double kMost = 1e6;

std::optional<double> number(const nlohmann::json& value) {
  if (!value.is_number()) return std::nullopt;
  const auto number = value.get<double>();
  return std::abs(number) <= kMost ? std::optional(number) : std::nullopt;
}

std::optional<Vec2> vector(const nlohmann::json& line, const char* key) {
  const auto field = line.find(key);
  if (field == line.end() || !field->is_array() || field->size() != 2) return std::nullopt;
  const auto x = number((*field)[0]);
  const auto y = number((*field)[1]);
  return x && y ? std::optional(Vec2(*x, *y)) : std::nullopt;
}

nlohmann::json to_json(const Vec2& v) { return {v.x(), v.y()}; }

}  // namespace

std::optional<LastKnown> last_known_in_log(const std::filesystem::path& run_dir, RobotId robot,
                                           const Mission& mission) {
  const std::filesystem::path file = robot_log::file_of(run_dir, robot);
  auto steps = robot_log::last_steps(file, utc_now() - kRecent);
  if (steps && steps->empty()) steps = robot_log::last_steps(file);
  if (!steps) return std::nullopt;
  return last_known(*steps, mission);
}

std::string to_line(const LastPosition& last) {
  const LastKnown& known = last.known;
  nlohmann::json line = {{"last", last.robot.value()},
                         {"utc_ns", known.at.time_since_epoch().count()},
                         {"position_m", to_json(known.position_m)},
                         {"command_mps", to_json(known.command_mps.value_or(Vec2::Zero()))},
                         {"speed_mps", nullptr},
                         {"final", known.is_last}};
  if (known.speed_mps) line["speed_mps"] = *known.speed_mps;
  return line.dump();
}

std::optional<LastPosition> parse_last_position(const nlohmann::json& line) {
  const auto robot = line.find("last");
  const auto utc_ns = line.find("utc_ns");
  const auto speed = line.find("speed_mps");
  const auto is_final = line.find("final");
  for (const auto& field : {robot, utc_ns, speed, is_final}) {
    if (field == line.end()) return std::nullopt;
  }
  const auto position_m = vector(line, "position_m");
  const auto command_mps = vector(line, "command_mps");
  if (!robot->is_number_unsigned() || !utc_ns->is_number_unsigned() || !is_final->is_boolean()) {
    return std::nullopt;
  }
  const auto id = robot->get<std::uint64_t>();
  const auto at_ns = utc_ns->get<std::uint64_t>();
  if (id > UINT32_MAX || at_ns > INT64_MAX || !position_m || !command_mps) return std::nullopt;
  const std::optional<double> speed_mps = number(*speed);
  if (!speed_mps && !speed->is_null()) return std::nullopt;
  return LastPosition{.robot = RobotId(static_cast<std::uint32_t>(id)),
                      .known = {.at = UtcTime(Duration(static_cast<std::int64_t>(at_ns))),
                                .position_m = *position_m,
                                .command_mps = *command_mps,
                                .speed_mps = speed_mps,
                                .is_last = is_final->get<bool>()}};
}

}  // namespace swarm::launcher
