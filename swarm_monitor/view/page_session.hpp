// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "swarm_monitor/view/session.hpp"
#include "swarm_monitor/view/view_source.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::monitor {

/// The page requests a frame, of a time in a recording or the newest.
struct FrameRequest {
  std::optional<double> time_s{};
};

/// The page chooses a robot, whose neighbours the following frames show; none: no robot.
struct FocusRequest {
  std::optional<RobotId> robot{};
};

enum class ControlAction { kPause, kResume, kStop, kGoal, kAddObstacle };

/// The action's name in PROTOCOL.md.
std::string_view name_of(ControlAction action);

/// The page wants to control the run.
struct ControlRequest {
  ControlAction action = ControlAction::kPause;
  std::string token{};    ///< from the printed address
  double x_m = 0.0;       ///< of goal and add_obstacle
  double y_m = 0.0;       ///< of goal and add_obstacle
  double radius_m = 0.0;  ///< of add_obstacle
};

using PageRequest = std::variant<FrameRequest, FocusRequest, ControlRequest>;

/// Parses a text frame of the page (PROTOCOL.md); any bytes are allowed as input.
Result<PageRequest> parse_page_request(std::string_view text);

/// Performs or refuses a control request. Returns the text of the answer.
using Control = std::function<Result<std::string>(const ControlRequest&)>;

/// A browser that shows the page.
class PageSession final : public Session {
 public:
  PageSession(ViewSource& source, Control control, ViewCounters& counters)
      : Session(counters), source_(source), control_(std::move(control)) {}

  /// Requests are short; longer frames are refused.
  std::size_t max_frame() const override { return 4096; }
  void take(std::string_view frame, bool binary) override;
  void refuse(const std::string& why) override;
  bool has_something() const override;
  bool next(Outgoing& out) override;

 private:
  // Performs a control request and queues its answer.
  void apply(const ControlRequest& request);
  // Each of these replaces `out` by the next message of its kind, if there is one.
  bool next_scene(Outgoing& out);
  bool next_events(Outgoing& out);
  bool next_series(Outgoing& out);

  ViewSource& source_;
  Control control_;
  std::optional<FrameRequest> wanted_;  // the frame requested last and not yet sent
  std::optional<RobotId> focus_;        // the chosen robot
  std::deque<std::string> answers_;
  std::size_t scenes_sent_ = 0;
  std::size_t events_sent_ = 0;
  std::size_t rows_sent_ = 0;
};

}  // namespace swarm::monitor
