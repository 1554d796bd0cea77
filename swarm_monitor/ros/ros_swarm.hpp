// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "swarm_ros/view_messages.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/world.hpp"
#include "swarmflow/observe/observer.hpp"

namespace swarm::monitor {

/// A run as messages of ROS 2 that RViz, Foxglove and rqt show: few large ones, since those choke
/// on a topic for each robot. Pure: the times are passed in, and nothing is published here. Call
/// nothing but on_mission() before the mission is known.
class RosSwarm final : public Observer {
 public:
  /// `frame`: frame_id of all messages.
  explicit RosSwarm(std::string frame) : frame_(std::move(frame)) {}

  void on_mission(const Mission& mission) override;
  void on_plan(const ObservedPlan& plan) override;
  void on_clock(const ObservedClock& clock) override { clock_ = clock; }
  void on_scene(const Scene& scene) override;
  void on_state(const ObservedState& state) override;
  void on_status(const ObservedStatus& status) override;
  void on_event(const ObservedEvent& event) override;

  /// The robots that have been received, in the order of their numbers: their positions moved on to
  /// now, and the direction in which each drives or drove last.
  ros::PoseArray poses(UtcTime now) const;

  /// The robots as one list of spheres, coloured by what they do, and the Gaussians of the planned
  /// mixture as ellipses of one standard deviation. They vanish by themselves after `lifetime`.
  ros::MarkerArray markers(UtcTime now, Duration lifetime) const;

  /// One status of the mission, for ten seconds with its last warning, and one of each robot: stale
  /// without a status for 3 s, a warning where it holds or is stopped.
  ros::DiagnosticArray diagnostics(UtcTime now) const;

  /// The obstacles now, bodies of dead robots included. A cell is occupied if its middle is inside
  /// one. O(cells).
  ros::OccupancyGrid map(double resolution_m, UtcTime now) const;
  /// Counts changes of the map; while an obstacle moves, each call does.
  std::uint64_t map_version(UtcTime now);

  std::size_t robots() const { return robots_.size(); }
  /// How many cells the map has at this resolution.
  double cells(double resolution_m) const;

 private:
  struct Robot {
    bool is_known = false;
    Vec2 position_m = Vec2::Zero();
    Vec2 velocity_mps = Vec2::Zero();
    UtcTime as_of{};
    double heading_rad = 0.0;
    RobotMode mode = RobotMode::kWaiting;
    bool arrived = false;
    std::optional<UtcTime> status_at{};
    std::uint32_t ticks = 0;
    std::uint32_t late_ticks = 0;
  };

  ros::Header header(UtcTime now) const;
  static Vec2 position_m(const Robot& robot, UtcTime now);
  ros::DiagnosticStatus mission_status(UtcTime now) const;
  ros::DiagnosticStatus robot_status(std::size_t i, UtcTime now) const;

  std::string frame_;
  std::optional<Mission> mission_;
  std::vector<Robot> robots_;
  FlowPlan flow_;
  std::uint32_t plan_version_ = 0;
  std::optional<ObservedClock> clock_;
  Scene scene_;
  std::uint64_t map_version_ = 0;
  std::string last_warning_;
  UtcTime warned_at_{};
};

}  // namespace swarm::monitor
