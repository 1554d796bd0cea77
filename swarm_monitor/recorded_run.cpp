// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/recorded_run.hpp"

#include <algorithm>
#include <numeric>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "swarm_core/blackbox/blackbox_file.hpp"
#include "swarm_core/mission/mission_file.hpp"
#include "swarm_core/plan/plan_json.hpp"
#include "swarm_core/shell/run_directory.hpp"

namespace swarm::monitor {
namespace {

constexpr std::size_t kMaxEventsBytes = 256U << 20U;
constexpr std::size_t kMaxPlanBytes = 64U << 20U;

template <class... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};

std::optional<UtcTime> first_stamp(const std::vector<blackbox::Record>& records) {
  for (const auto& record : records) {
    if (const auto* step = std::get_if<blackbox::Step>(&record)) return step->stamp;
  }
  return std::nullopt;
}

std::vector<RunEvent> read_events(const std::filesystem::path& file, UtcTime begin) {
  std::vector<RunEvent> events;
  const auto text = shell::read_file(file, kMaxEventsBytes);
  if (!text) return events;
  std::istringstream lines(*text);
  for (std::string line; std::getline(lines, line);) {
    // The last line of a killed launcher may be cut: what is no event is left out.
    const auto json = nlohmann::json::parse(line, nullptr, false);
    if (!json.is_object()) continue;
    const auto word = [&](const char* key) {
      const auto it = json.find(key);
      return it != json.end() && it->is_string() ? it->get<std::string>() : std::string();
    };
    const auto stamp = json.find("utc_ns");
    if (stamp == json.end() || !stamp->is_number_integer()) continue;
    const UtcTime at{Duration(stamp->get<std::int64_t>())};
    events.push_back({.time_s = to_seconds(at - begin),
                      .source = word("source"),
                      .severity = word("severity"),
                      .code = word("code"),
                      .text = word("text")});
  }
  return events;
}

}  // namespace

Track make_track(RobotId robot, const std::vector<blackbox::Record>& records, UtcTime begin) {
  Track track{.robot = robot};
  blackbox::LinkStats life;  // newest counters of the current life
  const auto close_life = [&] {
    track.state_age.merge(life.state_age);
    track.refused += std::accumulate(life.refused.begin(), life.refused.end(), std::uint64_t{0});
    life = {};
  };
  const auto add_step = [&](const blackbox::Step& step) {
    if (step.lateness_us > Track::kLate_us) ++track.late_steps;
    const double time_s = to_seconds(step.stamp - begin);
    if (!track.points.empty() && time_s <= track.points.back().time_s) {
      ++track.damaged;
      return;
    }
    track.points.push_back({.time_s = time_s,
                            .position_m = step.position_m,
                            .mode = static_cast<RobotMode>(step.mode),
                            .goal = step.goal});
  };
  for (const auto& record : records) {
    std::visit(Overloaded{[&](const blackbox::Header& header) {
                            close_life();
                            track.radius_m = header.radius_m;
                            track.processes.push_back(header.process_id);
                            track.ended_gracefully = false;
                          },
                          add_step, [&](const blackbox::LinkStats& stats) { life = stats; },
                          [&](const blackbox::Note& note) {
                            track.notes.push_back(note);
                            if (note.code == "exit") track.ended_gracefully = true;
                          }},
               record);
  }
  close_life();
  return track;
}

Result<RecordedRun> read_run(const std::filesystem::path& run_dir) {
  auto mission = load_mission(run_dir / shell::kMissionFile);
  if (!mission) {
    return fail(ErrorCode::kEnvironment, fmt::format("{} is no run directory:\n{}",
                                                     run_dir.string(), mission.error().message));
  }
  RecordedRun run{.mission = std::move(*mission)};
  std::vector<Result<blackbox::File>> files;
  std::optional<UtcTime> begin;
  for (std::uint32_t i = 0; i < run.mission.robots.count; ++i) {
    files.push_back(blackbox::read_file(blackbox::file_of(run_dir, RobotId(i))));
    if (!files.back()) continue;
    const auto stamp = first_stamp(files.back()->records);
    if (stamp && (!begin || *stamp < *begin)) begin = stamp;
  }
  if (!begin) {
    return fail(
        ErrorCode::kEnvironment,
        fmt::format("{}: no black box holds a step; did any robot start?", run_dir.string()));
  }
  run.begin = *begin;
  for (std::uint32_t i = 0; i < run.mission.robots.count; ++i) {
    if (!files[i]) {
      run.tracks.push_back({.robot = RobotId(i),
                            .radius_m = run.mission.robots.radius_m,
                            .unreadable = files[i].error().message});
      continue;
    }
    run.tracks.push_back(make_track(RobotId(i), files[i]->records, run.begin));
    run.tracks.back().damaged += files[i]->damaged;
    // A box without a header tells no radius: take the mission's.
    if (run.tracks.back().processes.empty())
      run.tracks.back().radius_m = run.mission.robots.radius_m;
  }
  if (const auto text = shell::read_file(run_dir / shell::kPlanFile, kMaxPlanBytes)) {
    if (auto plan = plan_from_json(*text)) run.plan = std::move(*plan);
  }
  run.events = read_events(run_dir / shell::kEventsFile, run.begin);
  return run;
}

}  // namespace swarm::monitor
