// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/run_inputs.hpp"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "swarmflow/mission/mission_file.hpp"

namespace swarm::shell {
namespace {

constexpr const char* kMissionKey = "mission_yaml";
constexpr std::size_t kMaxBytes = 64U << 20U;

}  // namespace

std::string to_json(const RunInfo& run, const std::string& mission_yaml) {
  auto json = nlohmann::json::parse(to_json(run));
  json[kMissionKey] = mission_yaml;
  // A mission may name things in any bytes; invalid UTF-8 cannot be in a document.
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Result<RunInputs> read_run_inputs(const std::filesystem::path& run_dir,
                                  const std::filesystem::path& inputs, const Catalogue& catalogue) {
  auto run = inputs.empty() ? read_run_info(run_dir) : read_run_info_file(inputs);
  if (!run) return tl::unexpected(run.error());
  if (inputs.empty()) {
    auto mission = load_mission(run_dir / kMissionFile, catalogue);
    if (!mission) return tl::unexpected(mission.error());
    return RunInputs{*std::move(run), *std::move(mission)};
  }
  const auto text = read_file(inputs, kMaxBytes);
  if (!text) return tl::unexpected(text.error());
  const auto json = nlohmann::json::parse(*text, nullptr, false);
  if (!json.is_object() || !json.contains(kMissionKey) || !json[kMissionKey].is_string()) {
    return fail(ErrorCode::kBadInput, fmt::format("{}: holds no mission", inputs.string()));
  }
  auto mission = parse_mission(json[kMissionKey].get<std::string>(), std::string(kMissionFile),
                               run_dir, catalogue);
  if (!mission) return tl::unexpected(mission.error());
  return RunInputs{*std::move(run), *std::move(mission)};
}

}  // namespace swarm::shell
