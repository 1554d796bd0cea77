// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/evidence.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "swarm_core/app/file_watch.hpp"
#include "swarm_core/app/run_directory.hpp"

namespace swarm::monitor {
namespace {

constexpr std::size_t kShown = 10;

void add_gaps_in_logs(const RecordedRun& run, std::vector<std::string>& missing) {
  std::uint64_t records = 0;
  std::vector<std::uint32_t> robots;
  for (const Track& track : run.tracks) {
    if (track.lost == 0) continue;
    records += track.lost;
    if (robots.size() < kShown) robots.push_back(track.robot.value());
  }
  if (records == 0) return;
  missing.push_back(fmt::format("{} record{} of robot logs: robot {}{}", records,
                                records == 1 ? "" : "s", fmt::join(robots, ", "),
                                robots.size() == kShown ? " …" : ""));
}

/// The version in "took scene version 17".
std::optional<std::uint64_t> taken_version(const robot_log::Note& note) {
  constexpr std::string_view kBegin = "took scene version ";
  if (note.code != "scene" || !note.text.starts_with(kBegin)) return std::nullopt;
  std::uint64_t version = 0;
  const char* const end = note.text.data() + note.text.size();
  const auto [stop, error] = std::from_chars(note.text.data() + kBegin.size(), end, version);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return version;
}

/// Robots fly by scenes that they received: what they took is a second record of what was changed.
void add_unknown_scenes(const RecordedRun& run, std::vector<std::string>& missing) {
  std::set<std::uint64_t> unknown;
  for (const Track& track : run.tracks) {
    for (const robot_log::Note& note : track.notes) {
      if (const auto version = taken_version(note)) unknown.insert(*version);
    }
  }
  for (const Scene& scene : run.scenes) unknown.erase(scene.version);
  if (unknown.empty()) return;
  missing.push_back(fmt::format("{} scene{} that robots took and {} lacks", unknown.size(),
                                unknown.size() == 1 ? "" : "s", shell::kSceneFile));
}

/// The planner removes old plans on purpose; the first and the newest have to be there. Robots name
/// plans as well: a planner that was killed may not have written those that they followed.
void add_unknown_plans(const RecordedRun& run, std::vector<std::string>& missing) {
  std::set<std::uint32_t> unknown;
  for (const PlanClock& reading : run.clock) unknown.insert(reading.plan_version);
  for (const Track& track : run.tracks) {
    for (const TrackPoint& point : track.points) {
      if (unknown.empty() || point.plan_version != *unknown.rbegin()) {
        unknown.insert(point.plan_version);
      }
    }
  }
  unknown.erase(0);
  if (unknown.empty()) return;
  const std::uint32_t newest = *unknown.rbegin();
  const std::uint32_t oldest_kept = newest < shell::kPlansKept ? 2 : newest - shell::kPlansKept + 1;
  for (const PublishedPlan& plan : run.plans) unknown.erase(plan.version);
  std::erase_if(unknown,
                [&](std::uint32_t version) { return version > 1 && version < oldest_kept; });
  if (unknown.empty()) return;
  missing.push_back(fmt::format("{} plan{} that the clock or robots name: version {}{}",
                                unknown.size(), unknown.size() == 1 ? "" : "s", *unknown.begin(),
                                unknown.size() == 1 ? "" : " …"));
}

/// Events of processes that could not write everything; those of the launcher are in its summary,
/// too, as the file of events may be the one that lacks them.
void add_reported_losses(const RecordedRun& run, std::vector<std::string>& missing) {
  std::set<std::string> reported;
  for (const RunEvent& event : run.events) {
    if (event.code == shell::kRecordsLost) reported.insert(event.source + ": " + event.text);
  }
  const auto summary = nlohmann::json::parse(run.launcher_summary, nullptr, false);
  if (summary.is_object() && summary.contains("missing") && summary["missing"].is_array()) {
    for (const auto& text : summary["missing"]) {
      if (text.is_string()) reported.insert(text.get<std::string>());
    }
  }
  // The summary of an earlier audit has what was found above, too.
  for (const std::string& known : missing) reported.erase(known);
  missing.insert(missing.end(), reported.begin(), reported.end());
}

}  // namespace

std::vector<std::string> missing_evidence(const RecordedRun& run) {
  std::vector<std::string> missing = run.gaps;
  add_gaps_in_logs(run, missing);
  add_unknown_scenes(run, missing);
  add_unknown_plans(run, missing);
  add_reported_losses(run, missing);
  return missing;
}

}  // namespace swarm::monitor
