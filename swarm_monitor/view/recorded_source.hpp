// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "swarm_monitor/audit/recorded_run.hpp"
#include "swarm_monitor/view/view_frame.hpp"
#include "swarm_monitor/view/view_source.hpp"

namespace swarm::monitor {

/// A finished run, as a viewer sees it.
class RecordedSource final : public ViewSource {
 public:
  /// Computes scenes, events and series of the whole run; the clearance of all robots dominates.
  explicit RecordedSource(RecordedRun run);

  /// A recording does not change.
  void poll(UtcTime) override {}
  bool live() const override { return false; }
  const std::vector<std::string>& scenes() const override { return scenes_; }
  const std::vector<std::string>& events() const override { return events_; }
  const std::vector<std::string>& series() const override { return series_; }
  void view_frame(std::optional<double> time_s, std::optional<RobotId> focus,
                  std::vector<std::byte>& out) override;
  Vec2 origin_m() const override { return view_origin_m(run_.mission.world.bounds_m()); }
  /// Empty: Foxglove opens a recording's file itself to get its messages.
  const std::vector<RawChannel>& raw_channels() const override { return no_channels_; }
  void on_raw(std::function<void(const RawSample&)>) override {}
  std::string metrics() const override;

 private:
  // One scene per phase of the map, with the goal that was in force.
  void make_scenes();
  void make_events();
  // One row per second: smallest gap, arrived and moving robots.
  void make_series();

  RecordedRun run_;
  double end_s_ = 0.0;          // last step of any robot
  double moving_from_s_ = 0.0;  // when the plan's time began
  std::vector<std::string> scenes_, events_, series_;
  std::vector<RawChannel> no_channels_;
};

}  // namespace swarm::monitor
