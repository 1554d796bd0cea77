// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/program/status_report.hpp"

#include <algorithm>

#include <unistd.h>

namespace swarm::agent {
namespace {

/// Largest number of robots whose status is one message.
constexpr std::size_t kGroup = 100;

/// The group that begins with a robot; the last one may be smaller.
std::span<const LocalRobot> group(std::span<const LocalRobot> robots, std::size_t first) {
  return robots.subspan(first, std::min(kGroup, robots.size() - first));
}

bool has_updates(std::span<const LocalRobot> robots) {
  return std::any_of(robots.begin(), robots.end(),
                     [](const LocalRobot& robot) { return robot.loop.has_updates(); });
}

}  // namespace

/// Groups take turns by their number, so that messages spread over the ticks of a status period.
void StatusReport::on_tick(const Source& source) {
  // The launcher starts the mission once all robots have the plan: a new plan is reported at once,
  // as is the presence of the process at its first tick, and a command, which users wait for. A
  // process that slept may be about to be killed for its silence.
  const std::uint32_t version = source.inbox.plan_version();
  const std::uint64_t command = source.inbox.command_id();
  const bool slept = last_tick_ && source.now - *last_tick_ > status_period_;
  last_tick_ = source.now;
  const bool all_have_updates =
      ticks_ == 0 || slept || version != plan_reported_ || command != command_reported_;
  plan_reported_ = version;
  command_reported_ = command;
  for (std::size_t first = 0; first < source.robots.size(); first += kGroup) {
    if (all_have_updates || cadence_.is_due(first / kGroup, ticks_) ||
        has_updates(group(source.robots, first))) {
      publish_group(source, first);
    }
  }
  ++ticks_;
}

void StatusReport::publish_all(const Source& source) {
  for (std::size_t first = 0; first < source.robots.size(); first += kGroup) {
    publish_group(source, first);
  }
}

/// Counters of the process belong to no single robot: the message of the first group carries them.
void StatusReport::publish_group(const Source& source, std::size_t first) {
  message_.first_robot_id = source.robots[first].loop.id().value();
  message_.process_id = static_cast<std::uint32_t>(::getpid());
  message_.plan_epoch = source.inbox.plan_epoch();
  message_.plan_version = source.inbox.plan_version();
  message_.plan_scene_version = source.inbox.plan_scene_version();
  message_.command_id = source.inbox.command_id();
  message_.stamp_utc_ns = source.utc_now.time_since_epoch().count();
  const auto plan_time = source.inbox.plan_time(source.now);
  message_.plan_time_s = plan_time ? plan_time->plan_time_s : 0.0;
  message_.robots.clear();
  for (const LocalRobot& robot : group(source.robots, first)) {
    message_.robots.push_back(robot.loop.status());
  }
  message_.refused.clear();
  message_.state_age.clear();
  if (first == 0) {
    const auto& refused = source.inbox.refused().all();
    message_.refused.assign(refused.begin(), refused.end());
    for (std::size_t i = 0; i < Histogram::kBins; ++i) {
      const auto count = static_cast<std::uint32_t>(source.state_age.bin(i));
      if (count > 0) message_.state_age.push_back({static_cast<std::uint16_t>(i), count});
    }
  }
  writer_.write(message_);
}

}  // namespace swarm::agent
