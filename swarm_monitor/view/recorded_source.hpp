// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarm_monitor/audit/recorded_run.hpp"
#include "swarm_monitor/view/view_source.hpp"

namespace swarm::monitor {

/// A run that has been flown, as a viewer sees it.
class RecordedSource final : public ViewSource {
 public:
  explicit RecordedSource(RecordedRun run);

  void poll(UtcTime) override {}
  bool live() const override { return false; }
  const std::vector<std::string>& scenes() const override { return scenes_; }
  const std::vector<std::string>& events() const override { return events_; }
  const std::vector<std::string>& series() const override { return series_; }
  void view_frame(std::optional<double> time_s, std::optional<RobotId> focus,
               std::vector<std::byte>& out) override;
  /// Whoever wants the messages of a recording opens its file.
  const std::vector<RawChannel>& raw_channels() const override { return no_channels_; }
  void on_raw(std::function<void(const RawSample&)>) override {}
  std::string metrics() const override;

 private:
  void make_scenes();
  void make_events();
  void make_series();

  RecordedRun run_;
  double end_s_ = 0.0;
  double moving_from_s_ = 0.0;  // when the plan's time began
  std::vector<std::string> scenes_, events_, series_;
  std::vector<RawChannel> no_channels_;
};

}  // namespace swarm::monitor
