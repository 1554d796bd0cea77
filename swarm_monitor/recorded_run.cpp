// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/recorded_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "swarm_core/blackbox/blackbox_file.hpp"
#include "swarm_core/mission/mission_file.hpp"
#include "swarm_core/mission/scene_log.hpp"
#include "swarm_core/plan/plan_json.hpp"
#include "swarm_core/shell/run_directory.hpp"

namespace swarm::monitor {
namespace {

constexpr std::size_t kMaxEventsBytes = 256U << 20U;
constexpr std::size_t kMaxPlanBytes = 64U << 20U;
constexpr std::size_t kMaxSceneBytes = 64U << 20U;

UtcTime stamp_of(const blackbox::Record& record) {
  return std::visit([](const auto& r) { return r.stamp; }, record);
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

void TrackMaker::add(const blackbox::Record& record) {
  std::visit([this](const auto& r) { take(r); }, record);
}

void TrackMaker::take(const blackbox::Header& header) {
  close_life();
  track_.radius_m = header.radius_m;
  track_.processes.push_back(header.process_id);
  track_.ended_gracefully = false;
}

void TrackMaker::take(const blackbox::Step& step) {
  if (step.lateness_us > Track::kLate_us) ++track_.late_steps;
  const double time_s = to_seconds(step.stamp - origin_);
  if (!track_.points.empty() && time_s <= track_.points.back().time_s) {
    ++track_.damaged;
    return;
  }
  track_.points.push_back({.time_s = time_s,
                           .position_m = step.position_m,
                           .mode = static_cast<RobotMode>(step.mode),
                           .goal = step.goal});
}

void TrackMaker::take(const blackbox::Belief& belief) {
  track_.beliefs.push_back({.time_s = to_seconds(belief.stamp - origin_),
                            .neighbour = belief.neighbour,
                            .position_m = belief.position_m});
}

void TrackMaker::take(const blackbox::Note& note) {
  track_.notes.push_back(note);
  if (note.code == "exit") track_.ended_gracefully = true;
}

void TrackMaker::close_life() {
  track_.state_age.merge(life_.state_age);
  track_.states_sent += life_.states_sent;
  track_.refused += std::accumulate(life_.refused.begin(), life_.refused.end(), std::uint64_t{0});
  life_ = {};
}

Track TrackMaker::finish() {
  close_life();
  return std::move(track_);
}

const Mixture& RecordedRun::goal() const {
  return scenes.empty() || !scenes.back().goal ? mission.goal : *scenes.back().goal;
}

Result<RecordedRun> read_run(const std::filesystem::path& run_dir) {
  auto mission = load_mission(run_dir / shell::kMissionFile);
  if (!mission) {
    return fail(ErrorCode::kEnvironment, fmt::format("{} is no run directory:\n{}",
                                                     run_dir.string(), mission.error().message));
  }
  RecordedRun run{.mission = std::move(*mission)};
  std::optional<UtcTime> origin;  // any stamp near the run: seconds since 1970 would be too coarse
  for (std::uint32_t i = 0; i < run.mission.robots.count; ++i) {
    std::optional<TrackMaker> maker;
    const auto damage =
        blackbox::read_records(blackbox::file_of(run_dir, RobotId(i)), [&](const auto& record) {
          if (!origin) origin = stamp_of(record);
          if (!maker) maker.emplace(RobotId(i), *origin);
          maker->add(record);
        });
    Track track = maker ? maker->finish() : Track{.robot = RobotId(i)};
    if (damage) {
      track.damaged += damage->damaged;
    } else {
      track.unreadable = damage.error().message;
    }
    // A box without a header tells no radius: take the mission's.
    if (track.processes.empty()) track.radius_m = run.mission.robots.radius_m;
    run.tracks.push_back(std::move(track));
  }
  double begin_s = std::numeric_limits<double>::infinity();
  for (const Track& track : run.tracks) {
    if (!track.points.empty()) begin_s = std::min(begin_s, track.points.front().time_s);
  }
  if (!std::isfinite(begin_s)) {
    return fail(
        ErrorCode::kEnvironment,
        fmt::format("{}: no black box holds a step; did any robot start?", run_dir.string()));
  }
  for (Track& track : run.tracks) {
    for (TrackPoint& point : track.points) point.time_s -= begin_s;
    for (BeliefPoint& belief : track.beliefs) belief.time_s -= begin_s;
  }
  run.begin = *origin + from_seconds(begin_s);
  if (const auto text = shell::read_file(run_dir / shell::kPlanFile, kMaxPlanBytes)) {
    if (auto plan = plan_from_json(*text)) run.plan = std::move(*plan);
  }
  run.scenes =
      replay_scene_log(shell::read_file(run_dir / shell::kSceneFile, kMaxSceneBytes).value_or(""),
                       run.mission.world);
  run.events = read_events(run_dir / shell::kEventsFile, run.begin);
  return run;
}

}  // namespace swarm::monitor
