// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/recorded_run.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <sstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/metrics/late_ticks.hpp"
#include "swarm_core/mission_file/scene_log.hpp"
#include "swarm_core/plan/plan_json.hpp"
#include "swarm_core/robot_log/reader.hpp"
#include "swarm_core/robot_log/robot_log_file.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::monitor {
namespace {

/// Limits on the files of a run directory. Far above what runs write; they keep a wrong or hostile
/// file from exhausting the memory.
constexpr std::size_t kMaxMissionBytes = 16U << 20U;
constexpr std::size_t kMaxSummaryBytes = 1U << 20U;
constexpr std::size_t kMaxEventsBytes = 256U << 20U;
constexpr std::size_t kMaxPlanBytes = 64U << 20U;
constexpr std::size_t kMaxSceneBytes = 64U << 20U;
constexpr std::size_t kMaxPlanningBytes = 64U << 10U;
constexpr std::size_t kMaxClockBytes = 64U << 20U;

/// Reads events.jsonl: one JSON object per line, with its stamp in UTC nanoseconds. Times become
/// seconds since the begin of the run. Lines without a stamp are left out, since they have no place
/// in the order of time.
std::vector<RunEvent> read_events(const std::string& text, UtcTime begin) {
  std::vector<RunEvent> events;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    // The last line of a killed launcher may be incomplete: lines that are not JSON objects are
    // left out.
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

void TrackMaker::add(const robot_log::Record& record) {
  std::visit([this](const auto& r) { take(r); }, record);
}

/// A header begins each incarnation of the robot's process. Its counters start from 0, so those of
/// the incarnation before are added first.
void TrackMaker::take(const robot_log::Header& header) {
  close_incarnation();
  track_.radius_m = header.radius_m;
  track_.processes.push_back(header.process_id);
  track_.ended_gracefully = false;
}

/// One control step. A step that does not ascend in time (a clock that was set back) counts as
/// damage: interpolation needs strictly ascending times.
void TrackMaker::take(const robot_log::Step& step) {
  const Duration lateness = std::chrono::microseconds(step.lateness_us);
  track_.late_ticks += late_ticks(lateness, period_);
  if (period_ > Duration::zero() && lateness >= period_) {
    track_.missed_ticks += static_cast<std::uint64_t>(lateness / period_);
  }
  const double time_s = to_seconds(step.stamp - origin_);
  if (!track_.points.empty() && time_s <= track_.points.back().time_s) {
    ++track_.damaged;
    return;
  }
  track_.points.push_back({.time_s = time_s,
                           .position_m = step.position_m,
                           .mode = static_cast<RobotMode>(step.mode),
                           .goal = step.goal,
                           .neighbours = step.neighbours,
                           .plan_version = step.plan_version,
                           .plan_time_s = step.plan_time_s,
                           .reference_x_m = step.reference_x_m,
                           .reference_y_m = step.reference_y_m});
  last_step_ = step;
}

void TrackMaker::take(const robot_log::Estimate& estimate) {
  track_.estimates.push_back({.time_s = to_seconds(estimate.stamp - origin_),
                              .neighbour = estimate.neighbour,
                              .position_m = estimate.position_m});
}

/// The note "exit" is the last record of a process that ended gracefully; without it the robot is
/// lost.
void TrackMaker::take(const robot_log::Note& note) {
  track_.notes.push_back(note);
  if (note.code == "exit") track_.ended_gracefully = true;
}

/// The body of a robot whose process died drives on until its last command runs out. A simulation,
/// which has no period here, records that itself.
void TrackMaker::let_body_come_to_rest() {
  const robot_log::Step last = std::exchange(last_step_, {});
  const bool drives_on = !track_.ended_gracefully && last.velocity_mps != Vec2::Zero();
  if (period_ == Duration::zero() || track_.points.empty() || !drives_on) return;
  TrackPoint rest = track_.points.back();
  rest.is_rest = true;
  rest.time_s += to_seconds(robot_log::command_lifetime(period_));
  rest.position_m = robot_log::rest_position_m(last, period_);
  track_.points.push_back(rest);
}

/// Adds the newest counters of an incarnation to the track: link statistics are cumulative within
/// an incarnation, so only the last record counts.
void TrackMaker::close_incarnation() {
  let_body_come_to_rest();
  track_.state_age.merge(incarnation_.state_age);
  track_.states_sent += incarnation_.states_sent;
  track_.refused +=
      std::accumulate(incarnation_.refused.begin(), incarnation_.refused.end(), std::uint64_t{0});
  incarnation_ = {};
}

/// Closes the last incarnation, whose counters no later header closes.
Track TrackMaker::finish() {
  close_incarnation();
  return std::exchange(track_, {});
}

/// The newest scene with a goal of its own decides; without one the mission file's goal holds.
const Mixture& RecordedRun::goal() const {
  return scenes.empty() || !scenes.back().goal ? mission.goal : *scenes.back().goal;
}

namespace {

/// The text files of a run beside its robot logs, by name.
using Texts = std::map<std::string, std::string, std::less<>>;

/// The text of a file, empty if the run has none: readers of optional files treat both alike.
const std::string& text_of(const Texts& texts, std::string_view name) {
  static const std::string kNone;
  const auto it = texts.find(name);
  return it == texts.end() ? kNone : it->second;
}

/// The version of the plan in a file: 1 for `plan.json`, 2 for `plan-0002.json`, 0 for any other
/// name.
std::uint32_t plan_version_of(std::string_view file) {
  if (file == shell::kPlanFile) return 1;
  constexpr std::string_view kBegin = "plan-", kEnd = ".json";
  if (!file.starts_with(kBegin) || !file.ends_with(kEnd)) return 0;
  file.remove_prefix(kBegin.size());
  if (file.size() <= kEnd.size()) return 0;
  file.remove_suffix(kEnd.size());
  std::uint32_t version = 0;
  const auto [end, error] = std::from_chars(file.data(), file.data() + file.size(), version);
  return error == std::errc{} && end == file.data() + file.size() ? version : 0;
}

/// All plans of a run by ascending version. A plan that cannot be read is left out: the audit then
/// reports that the clock names a plan that was not recorded.
std::vector<PublishedPlan> read_plans(const Texts& texts) {
  std::vector<PublishedPlan> plans;
  for (const auto& [name, text] : texts) {
    const std::uint32_t version = plan_version_of(name);
    if (version == 0) continue;
    auto plan = plan_from_json(text);
    if (plan) plans.push_back({version, std::move(*plan), excess_from_json(text)});
  }
  const auto older = [](const PublishedPlan& a, const PublishedPlan& b) {
    return a.version < b.version;
  };
  std::sort(plans.begin(), plans.end(), older);
  return plans;
}

/// Tracks under construction, by robot. Times are taken relative to the first record that is read
/// and shifted to the first step at the end: seconds since 1970 as a double resolve only 0.2 µs,
/// which is too coarse for differences of nanosecond stamps.
class TrackTable {
 public:
  explicit TrackTable(const Mission& mission)
      : period_(from_seconds(1.0 / mission.control.rate_hz)), makers_(mission.robots.count) {}

  // Records of robots that the mission does not have are ignored: a directory may hold logs of an
  // earlier, larger run.
  void add(RobotId robot, const robot_log::Record& record) {
    if (robot.value() >= makers_.size()) return;
    if (!origin_) origin_ = robot_log::stamp_of(record);
    auto& maker = makers_[robot.value()];
    if (!maker) maker.emplace(robot, *origin_, period_);
    maker->add(record);
  }

  /// Makes `run.begin` the first step. False if there is none.
  bool finish(RecordedRun& run) {
    double begin_s = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < makers_.size(); ++i) {
      Track track = makers_[i] ? makers_[i]->finish() : Track{.robot = RobotId(i)};
      // A log without a header has no radius: the mission's default holds.
      if (track.processes.empty()) track.radius_m = run.mission.robots.radius_m;
      if (!track.points.empty()) begin_s = std::min(begin_s, track.points.front().time_s);
      run.tracks.push_back(std::move(track));
    }
    if (!std::isfinite(begin_s)) return false;
    // In whole nanoseconds, so that the result does not depend on which record was read first.
    const Duration begin = from_seconds(begin_s);
    const auto since_begin = [begin](double time_s) {
      return to_seconds(from_seconds(time_s) - begin);
    };
    for (Track& track : run.tracks) {
      for (TrackPoint& point : track.points) point.time_s = since_begin(point.time_s);
      for (EstimatePoint& estimate : track.estimates)
        estimate.time_s = since_begin(estimate.time_s);
    }
    run.begin = *origin_ + begin;
    return true;
  }

 private:
  Duration period_;
  std::vector<std::optional<TrackMaker>> makers_;
  std::optional<UtcTime> origin_;
};

/// Parses the mission of a run. Components that this program does not know are accepted (open
/// catalogue): a run of a user's own driver or method can be audited.
Result<RecordedRun> with_mission(const std::string& yaml, const std::filesystem::path& from) {
  auto mission = parse_mission(yaml, std::string(shell::kMissionFile), {}, open_catalogue());
  if (!mission) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("{} is no recorded run:\n{}", from.string(), mission.error().message));
  }
  return RecordedRun{.mission = std::move(*mission)};
}

/// Adds the files that directory and recording have in common. Fails if no log holds a step: then
/// there is no time axis and nothing to audit.
Result<RecordedRun> finished(RecordedRun run, TrackTable& tracks, const Texts& texts,
                             const std::filesystem::path& from) {
  if (!tracks.finish(run)) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("{}: no robot log holds a step; did any robot start?", from.string()));
  }
  run.plans = read_plans(texts);
  run.planning = planning_record_from_json(text_of(texts, shell::kPlanningFile));
  run.clock = read_plan_clock(text_of(texts, shell::kPlanClockFile));
  run.scenes = replay_scene_log(text_of(texts, shell::kSceneFile), run.mission.world);
  run.events = read_events(text_of(texts, shell::kEventsFile), run.begin);
  run.launcher_summary = text_of(texts, shell::kSummaryFile);
  return run;
}

/// Reads a run directory. Robot logs are read one after the other and only their tracks are kept.
/// Damage of a log is reported at its robot and does not end the audit.
Result<RecordedRun> read_directory(const std::filesystem::path& run_dir) {
  Texts texts;
  for (const auto& [name, limit] : {std::pair{shell::kMissionFile, kMaxMissionBytes},
                                    {shell::kPlanningFile, kMaxPlanningBytes},
                                    {shell::kPlanClockFile, kMaxClockBytes},
                                    {shell::kSceneFile, kMaxSceneBytes},
                                    {shell::kEventsFile, kMaxEventsBytes},
                                    {shell::kSummaryFile, kMaxSummaryBytes}}) {
    if (auto text = shell::read_file(run_dir / name, limit)) texts[std::string(name)] = *text;
  }
  std::error_code unreadable;
  for (const auto& entry : std::filesystem::directory_iterator(run_dir, unreadable)) {
    const std::string name = entry.path().filename().string();
    if (plan_version_of(name) == 0) continue;
    if (auto text = shell::read_file(entry.path(), kMaxPlanBytes)) texts[name] = *text;
  }
  if (text_of(texts, shell::kMissionFile).empty()) {
    return fail(ErrorCode::kEnvironment, fmt::format("{} holds no {}: is it a run directory?",
                                                     run_dir.string(), shell::kMissionFile));
  }
  auto run = with_mission(text_of(texts, shell::kMissionFile), run_dir);
  if (!run) return run;
  TrackTable tracks(run->mission);
  std::vector<Result<robot_log::Damage>> damages;
  for (std::uint32_t i = 0; i < run->mission.robots.count; ++i) {
    damages.push_back(
        robot_log::read_records(robot_log::file_of(run_dir, RobotId(i)),
                                [&](const auto& record) { tracks.add(RobotId(i), record); }));
  }
  run = finished(std::move(*run), tracks, texts, run_dir);
  if (!run) return run;
  for (std::size_t i = 0; i < damages.size(); ++i) {
    if (damages[i]) {
      run->tracks[i].damaged += damages[i]->damaged;
      run->tracks[i].lost = damages[i]->lost;
    } else {
      run->tracks[i].unreadable = damages[i].error().message;
    }
  }
  return run;
}

/// What a recording lacks. Unlike those of a robot log, its messages are not numbered by robot:
/// what damage hides is not known.
std::vector<std::string> gaps_of(const mcap::Damage& damage, const std::string& lost_before) {
  std::vector<std::string> gaps;
  if (damage.damaged > 0) {
    gaps.push_back(fmt::format("what {} damaged place{} of the recording held", damage.damaged,
                               damage.damaged == 1 ? "" : "s"));
  }
  if (!damage.ended) gaps.emplace_back("the end of the recording");
  if (!lost_before.empty() && lost_before != "0") {
    gaps.push_back(fmt::format("{} records of the robot logs that were merged", lost_before));
  }
  return gaps;
}

/// Reads a recording in one pass. The mission must be attached before the first robot record, as
/// merge writes it, since it sets the number of tracks.
Result<RecordedRun> read_recording(const std::filesystem::path& file) {
  Texts texts;
  std::optional<TrackTable> tracks;
  std::optional<Result<RecordedRun>> run;
  std::string lost_before;  // records that the merged logs lacked
  const auto damage = mcap::read(
      file,
      {.message =
           [&](const mcap::Message& message, const mcap::Channel& channel, const mcap::Schema&) {
             if (!tracks) return;
             if (const auto record = robot_log::decode(message, channel)) {
               tracks->add(record->robot, record->record);
             }
           },
       .attachment =
           [&](const mcap::Attachment& attachment) {
             texts[attachment.name] = attachment.data;
             if (attachment.name != shell::kMissionFile || run) return;
             run = with_mission(attachment.data, file);
             if (*run) tracks.emplace((*run)->mission);
           },
       .metadata =
           [&](const mcap::Metadata& metadata) {
             if (metadata.name != robot_log::kMergeMetadata) return;
             const auto lost = metadata.values.find(std::string(robot_log::kMergeLost));
             if (lost != metadata.values.end()) lost_before = lost->second;
           }});
  if (!damage) return tl::unexpected(damage.error());
  if (!run) {
    return fail(ErrorCode::kEnvironment, fmt::format("{} holds no {}: is it a recording of a run?",
                                                     file.string(), shell::kMissionFile));
  }
  if (!*run) return *run;
  run = finished(std::move(**run), *tracks, texts, file);
  if (!*run) return *run;
  // The reader cannot attribute damaged bytes of a merged file to a robot, so the first robot
  // carries the count: the audit reports the sum.
  if (damage->damaged > 0) (*run)->tracks.front().damaged += damage->damaged;
  (*run)->gaps = gaps_of(*damage, lost_before);
  for (Track& track : (*run)->tracks) {
    if (track.points.empty()) track.unreadable = "the recording holds nothing of this robot";
  }
  return *run;
}

}  // namespace

/// The largest excess over all plans, since any of them was flown.
double RecordedRun::plan_excess_m() const {
  double largest_m = 0.0;
  for (const PublishedPlan& plan : plans) largest_m = std::max(largest_m, plan.excess_m);
  return largest_m;
}

/// A file is a recording, a directory the run directory itself: both give the same tracks.
Result<RecordedRun> read_run(const std::filesystem::path& from) {
  return std::filesystem::is_regular_file(from) ? read_recording(from) : read_directory(from);
}

}  // namespace swarm::monitor
