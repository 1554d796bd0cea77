// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/simulation/recording.hpp"

#include <utility>

#include "swarm_core/blackbox/blackbox_file.hpp"

namespace swarm::launcher {

Recording::Recording(const Mission& mission, UtcTime begin, bool steps)
    : mission_(mission), begin_(begin), keeps_steps_(steps), robots_(mission.robots.count) {}

void Recording::note(RobotId robot, UtcTime at, std::string code, std::string text) {
  robots_[robot.value()].notes.push_back(
      {.stamp = at, .code = std::move(code), .text = std::move(text)});
}

/// The records of one robot in the order a process would have written them.
template <class Take>
void Recording::replay(std::uint32_t robot, Take take) const {
  take(blackbox::Header{.robot = RobotId(robot),
                        .robots = mission_.robots.count,
                        .process_id = 0,
                        .radius_m = body_of(mission_.robots, RobotId(robot)).radius_m,
                        .stamp = begin_});
  const Robot& kept = robots_[robot];
  auto note = kept.notes.begin();
  for (const blackbox::Step& step : kept.steps) {
    for (; note != kept.notes.end() && note->stamp < step.stamp; ++note) take(*note);
    take(step);
  }
  if (robot == 0) {
    take(blackbox::LinkStats{.stamp = kept.steps.empty() ? begin_ : kept.steps.back().stamp,
                             .states_sent = static_cast<std::uint32_t>(link_.states_sent),
                             .states_received = static_cast<std::uint32_t>(link_.states_received),
                             .state_age = link_.state_age});
  }
  for (; note != kept.notes.end(); ++note) take(*note);
}

std::vector<monitor::Track> Recording::tracks() const {
  std::vector<monitor::Track> tracks;
  tracks.reserve(robots_.size());
  for (std::uint32_t i = 0; i < robots_.size(); ++i) {
    monitor::TrackMaker maker(RobotId(i), begin_);
    replay(i, [&](const auto& record) { maker.take(record); });
    tracks.push_back(maker.finish());
  }
  return tracks;
}

Result<void> Recording::write(const std::filesystem::path& run_dir) const {
  for (std::uint32_t i = 0; i < robots_.size(); ++i) {
    blackbox::Batch box;
    replay(i, [&](const auto& record) { box.append(record); });
    if (auto written = box.write(blackbox::file_of(run_dir, RobotId(i))); !written) return written;
  }
  return {};
}

}  // namespace swarm::launcher
