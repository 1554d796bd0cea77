// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/mission/channel.hpp"
#include "swarm_monitor/view/swarm_state.hpp"
#include "swarm_monitor/view/view_frame.hpp"
#include "swarm_monitor/view/view_source.hpp"

namespace swarm::monitor {

/// A run in progress, as a viewer sees it.
class LiveSource final : public ViewSource {
 public:
  /// `control`: whether the page offers to control the run.
  LiveSource(Mission mission, const shell::RunInfo& run, std::unique_ptr<BusTap> tap, bool control);

  /// Drains the bus and updates scenes, events and series.
  void poll(UtcTime now) override;
  bool live() const override { return true; }
  /// Texts of earlier scenes are empty: only the newest is shown of a run in progress.
  const std::vector<std::string>& scenes() const override { return scenes_; }
  const std::vector<std::string>& events() const override { return events_; }
  const std::vector<std::string>& series() const override { return series_; }
  void view_frame(std::optional<double> time_s, std::optional<RobotId> focus,
                  std::vector<std::byte>& out) override;
  Vec2 origin_m() const override { return view_origin_m(mission_.world.bounds_m()); }
  const std::vector<RawChannel>& raw_channels() const override { return raw_channels_; }
  void on_raw(std::function<void(const RawSample&)> sink) override { raw_sink_ = std::move(sink); }
  std::string metrics() const override;

  /// For `top`, which shows the same state in a terminal.
  const SwarmState& state() const { return state_; }
  const Mission& mission() const { return mission_; }
  const Mixture& goal() const;  ///< as it is now

 private:
  // Appends the scene if it changed or an obstacle moves.
  void add_scene();
  // Appends a row of the series: what was received since the last one.
  void add_row();

  Mission mission_;
  Channel channel_;
  bool control_;
  std::unique_ptr<BusTap> tap_;
  SwarmState state_;
  UtcTime now_{};  // of the last poll
  std::uint64_t scene_version_ = 0;
  UtcTime moved_at_{};  // when obstacles under way were last shown
  UtcTime row_at_{};
  std::uint64_t received_at_row_ = 0;
  std::vector<std::string> scenes_, events_, series_;
  std::vector<RawChannel> raw_channels_;
  std::function<void(const RawSample&)> raw_sink_;
};

/// Joins a run. Fails if its directory holds no run information, or if the bus cannot be received.
Result<std::unique_ptr<LiveSource>> look_at_run(const std::filesystem::path& run_dir,
                                                std::uint32_t number, bool control = false);

}  // namespace swarm::monitor
