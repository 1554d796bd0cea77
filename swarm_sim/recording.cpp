// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_sim/recording.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "swarm_core/base/assert.hpp"
#include "swarm_core/robot_log/robot_log_file.hpp"

namespace swarm::launcher {
namespace {

/// The counters of a log have 32 bits, enough for one robot. Those of all robots of a large swarm
/// stop at the largest number instead of starting over.
std::uint32_t at_most_32_bits(std::uint64_t count) {
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>(count, std::numeric_limits<std::uint32_t>::max()));
}

}  // namespace

Recording::Recording(const Mission& mission, UtcTime begin, std::uint64_t keeps_every)
    : mission_(mission),
      begin_(begin),
      keeps_every_(keeps_every),
      notes_(mission.robots.count),
      estimates_(mission.robots.count) {
  SWARM_ASSERT(keeps_every >= 1);
}

/// A note of the same stamp as the robot's step is written before or after it as in a process,
/// which appends to one file.
void Recording::note(RobotId robot, robot_log::Note note) {
  const bool follows_step = !periods_.empty() && periods_.back()[robot.value()].stamp == note.stamp;
  notes_[robot.value()].push_back({.note = std::move(note), .follows_step = follows_step});
}

/// Backwards through the periods: a dead robot has no steps in the latest ones.
std::vector<robot_log::Step> Recording::last_steps(RobotId robot) const {
  std::vector<robot_log::Step> steps;
  for (auto period = periods_.rbegin(); period != periods_.rend() && steps.size() < 2; ++period) {
    const robot_log::Step& step = (*period)[robot.value()];
    if (step.stamp != kNever) steps.insert(steps.begin(), step);
  }
  return steps;
}

/// The records of one robot in the order a process would have written them.
template <class Take>
void Recording::replay(std::uint32_t robot, Take take) const {
  take(robot_log::Header{.robot = RobotId(robot),
                         .robots = mission_.robots.count,
                         .process_id = 0,
                         .radius_m = body_of(mission_.robots, RobotId(robot)).radius_m,
                         .stamp = begin_});
  // Merges three sequences by their stamps: notes, steps of the periods, and estimates.
  auto note = notes_[robot].begin();
  const auto last_note = notes_[robot].end();
  auto estimate = estimates_[robot].begin();
  const auto last_estimate = estimates_[robot].end();
  UtcTime last_step = begin_;
  for (const std::vector<robot_log::Step>& period : periods_) {
    const robot_log::Step& step = period[robot];
    if (step.stamp == kNever) continue;
    const auto comes_first = [&](const PlacedNote& placed) {
      return placed.note.stamp < step.stamp ||
             (placed.note.stamp == step.stamp && !placed.follows_step);
    };
    for (; note != last_note && comes_first(*note); ++note) take(note->note);
    take(step);
    last_step = step.stamp;
    for (; estimate != last_estimate && estimate->stamp <= step.stamp; ++estimate) take(*estimate);
  }
  // The link's counters belong to all robots: the first log has them, before the last notes, with
  // the stamp of its last step, which a robot that died took before the last period.
  if (robot == 0) {
    take(robot_log::LinkStats{.stamp = last_step,
                              .states_sent = at_most_32_bits(link_.states_sent),
                              .states_received = at_most_32_bits(link_.states_received),
                              .refused = link_.refused,
                              .state_age = link_.state_age});
  }
  for (; note != last_note; ++note) take(note->note);
}

/// By the code that reads log files, so that an audit of a recording and of its files agree.
std::vector<monitor::Track> Recording::tracks() const {
  std::vector<monitor::Track> tracks;
  tracks.reserve(notes_.size());
  for (std::uint32_t i = 0; i < notes_.size(); ++i) {
    monitor::TrackMaker maker(RobotId(i), begin_);
    replay(i, [&](const auto& record) { maker.take(record); });
    tracks.push_back(maker.finish());
  }
  return tracks;
}

/// One file at a time: only one robot's log is in memory as a file.
Result<void> Recording::write(const std::filesystem::path& run_dir) const {
  for (std::uint32_t i = 0; i < notes_.size(); ++i) {
    robot_log::Batch box;
    replay(i, [&](const auto& record) { box.append(record); });
    if (auto written = box.write(robot_log::file_of(run_dir, RobotId(i))); !written) return written;
  }
  return {};
}

}  // namespace swarm::launcher
