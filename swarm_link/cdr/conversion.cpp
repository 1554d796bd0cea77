// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/cdr/conversion.hpp"

#include "swarm_link/wire_bounds.hpp"

namespace swarm::link::cdr {

static_assert(kMaxPlanNodes == wire::MAX_PLAN_NODES && kMaxPlanLegs == wire::MAX_PLAN_LEGS &&
              kMaxCellStates == wire::MAX_CELL_STATES && kMaxPlanRobots == wire::MAX_PLAN_ROBOTS &&
              kMaxSceneObstacles == wire::MAX_SCENE_OBSTACLES &&
              kMaxSceneRemoved == wire::MAX_SCENE_REMOVED &&
              kMaxSceneVertices == wire::MAX_SCENE_VERTICES &&
              kMaxSceneGoals == wire::MAX_SCENE_GOALS &&
              kMaxRefusalReasons == wire::MAX_REFUSAL_REASONS &&
              kMaxHistogramBins == wire::MAX_HISTOGRAM_BINS &&
              kSchemaVersion == wire::SCHEMA_VERSION && kNoRobot == wire::NO_ROBOT);

bool to_wire(const PlanMessage& in, wire::FlowPlan& out) {
  if (!fits_wire(in)) return false;
  out.schema_version(in.schema_version);
  out.version(in.version);
  out.epoch(in.epoch);
  out.scene_version(in.scene_version);
  out.t0_utc_ns(in.t0_utc_ns);
  out.excess_m(in.excess_m);
  out.nodes().resize(in.nodes.size());
  for (std::size_t i = 0; i < in.nodes.size(); ++i) {
    const auto& node = in.nodes[i];
    auto& wire_node = out.nodes()[i];
    wire_node.mean_x_m(node.mean_x_m);
    wire_node.mean_y_m(node.mean_y_m);
    wire_node.covariance_xx_m2(node.covariance_xx_m2);
    wire_node.covariance_xy_m2(node.covariance_xy_m2);
    wire_node.covariance_yy_m2(node.covariance_yy_m2);
    wire_node.time_s(node.time_s);
    wire_node.mass(node.mass);
  }
  out.legs().resize(in.legs.size());
  for (std::size_t i = 0; i < in.legs.size(); ++i) {
    out.legs()[i].from_node(in.legs[i].from_node);
    out.legs()[i].to_node(in.legs[i].to_node);
    out.legs()[i].mass(in.legs[i].mass);
  }
  out.entries().resize(in.entries.size());
  for (std::size_t i = 0; i < in.entries.size(); ++i) {
    out.entries()[i].source(in.entries[i].source);
    out.entries()[i].share(in.entries[i].share);
  }
  return true;
}

void from_wire(const wire::FlowPlan& in, PlanMessage& out) {
  out.schema_version = in.schema_version();
  out.version = in.version();
  out.epoch = in.epoch();
  out.scene_version = in.scene_version();
  out.t0_utc_ns = in.t0_utc_ns();
  out.excess_m = in.excess_m();
  out.nodes.clear();
  out.nodes.reserve(in.nodes().size());
  for (const auto& node : in.nodes()) {
    out.nodes.push_back({.mean_x_m = node.mean_x_m(),
                         .mean_y_m = node.mean_y_m(),
                         .covariance_xx_m2 = node.covariance_xx_m2(),
                         .covariance_xy_m2 = node.covariance_xy_m2(),
                         .covariance_yy_m2 = node.covariance_yy_m2(),
                         .time_s = node.time_s(),
                         .mass = node.mass()});
  }
  out.legs.clear();
  out.legs.reserve(in.legs().size());
  for (const auto& leg : in.legs()) {
    out.legs.push_back(
        {.from_node = leg.from_node(), .to_node = leg.to_node(), .mass = leg.mass()});
  }
  out.entries.clear();
  out.entries.reserve(in.entries().size());
  for (const auto& entry : in.entries()) {
    out.entries.push_back({.source = entry.source(), .share = entry.share()});
  }
}

bool to_wire(const SceneMessage& in, wire::Scene& out) {
  if (!fits_wire(in)) return false;
  out.schema_version(in.schema_version);
  out.version(in.version);
  out.risk_alpha(in.risk_alpha);
  out.next_id(in.next_id);
  out.removed(in.removed);
  out.obstacles().resize(in.obstacles.size());
  for (std::size_t i = 0; i < in.obstacles.size(); ++i) {
    const auto& obstacle = in.obstacles[i];
    auto& wire_obstacle = out.obstacles()[i];
    wire_obstacle.obstacle_id(obstacle.obstacle_id);
    wire_obstacle.owner_robot_id(obstacle.owner_robot_id);
    wire_obstacle.vertices(obstacle.vertices);
    wire_obstacle.center().x_m(obstacle.center.x_m);
    wire_obstacle.center().y_m(obstacle.center.y_m);
    wire_obstacle.radius_m(obstacle.radius_m);
    wire_obstacle.velocity_x_mps(obstacle.velocity_x_mps);
    wire_obstacle.velocity_y_mps(obstacle.velocity_y_mps);
    wire_obstacle.moving_from_utc_ns(obstacle.moving_from_utc_ns);
    wire_obstacle.moving_until_utc_ns(obstacle.moving_until_utc_ns);
  }
  out.vertices().resize(in.vertices.size());
  for (std::size_t i = 0; i < in.vertices.size(); ++i) {
    out.vertices()[i].x_m(in.vertices[i].x_m);
    out.vertices()[i].y_m(in.vertices[i].y_m);
  }
  out.goal().resize(in.goal.size());
  for (std::size_t i = 0; i < in.goal.size(); ++i) {
    const auto& goal = in.goal[i];
    auto& wire_goal = out.goal()[i];
    wire_goal.mean_x_m(goal.mean_x_m);
    wire_goal.mean_y_m(goal.mean_y_m);
    wire_goal.covariance_xx_m2(goal.covariance_xx_m2);
    wire_goal.covariance_xy_m2(goal.covariance_xy_m2);
    wire_goal.covariance_yy_m2(goal.covariance_yy_m2);
    wire_goal.weight(goal.weight);
  }
  return true;
}

void from_wire(const wire::Scene& in, SceneMessage& out) {
  out.schema_version = in.schema_version();
  out.version = in.version();
  out.risk_alpha = in.risk_alpha();
  out.next_id = in.next_id();
  out.removed = in.removed();
  out.obstacles.clear();
  for (const auto& obstacle : in.obstacles()) {
    out.obstacles.push_back({.obstacle_id = obstacle.obstacle_id(),
                             .owner_robot_id = obstacle.owner_robot_id(),
                             .vertices = obstacle.vertices(),
                             .center = {obstacle.center().x_m(), obstacle.center().y_m()},
                             .radius_m = obstacle.radius_m(),
                             .velocity_x_mps = obstacle.velocity_x_mps(),
                             .velocity_y_mps = obstacle.velocity_y_mps(),
                             .moving_from_utc_ns = obstacle.moving_from_utc_ns(),
                             .moving_until_utc_ns = obstacle.moving_until_utc_ns()});
  }
  out.vertices.clear();
  for (const auto& vertex : in.vertices()) out.vertices.push_back({vertex.x_m(), vertex.y_m()});
  out.goal.clear();
  for (const auto& goal : in.goal()) {
    out.goal.push_back({.mean_x_m = goal.mean_x_m(),
                        .mean_y_m = goal.mean_y_m(),
                        .covariance_xx_m2 = goal.covariance_xx_m2(),
                        .covariance_xy_m2 = goal.covariance_xy_m2(),
                        .covariance_yy_m2 = goal.covariance_yy_m2(),
                        .weight = goal.weight()});
  }
}

bool to_wire(const HeartbeatMessage& in, wire::Heartbeat& out) {
  out.schema_version(in.schema_version);
  out.phase(static_cast<std::uint8_t>(in.phase));
  out.version(in.version);
  out.epoch(in.epoch);
  out.sequence_number(in.sequence_number);
  out.stamp_utc_ns(in.stamp_utc_ns);
  out.mission_time_s(in.mission_time_s);
  out.plan_time_s(in.plan_time_s);
  out.plan_rate(in.plan_rate);
  return true;
}

void from_wire(const wire::Heartbeat& in, HeartbeatMessage& out) {
  out.schema_version = in.schema_version();
  out.phase = static_cast<MissionPhase>(in.phase());
  out.version = in.version();
  out.epoch = in.epoch();
  out.sequence_number = in.sequence_number();
  out.stamp_utc_ns = in.stamp_utc_ns();
  out.mission_time_s = in.mission_time_s();
  out.plan_time_s = in.plan_time_s();
  out.plan_rate = in.plan_rate();
}

bool to_wire(const CellStatesMessage& in, wire::CellStates& out) {
  if (!fits_wire(in)) return false;
  out.schema_version(in.schema_version);
  out.cell_x(in.cell_x);
  out.cell_y(in.cell_y);
  out.states().resize(in.states.size());
  for (std::size_t i = 0; i < in.states.size(); ++i) {
    const auto& state = in.states[i];
    auto& wire_state = out.states()[i];
    wire_state.robot_id(state.robot_id);
    wire_state.sequence_number(state.sequence_number);
    wire_state.stamp_utc_ns(state.stamp_utc_ns);
    wire_state.x_m(state.x_m);
    wire_state.y_m(state.y_m);
    wire_state.vx_mps(state.vx_mps);
    wire_state.vy_mps(state.vy_mps);
    wire_state.mode(static_cast<std::uint8_t>(state.mode));
  }
  return true;
}

void from_wire(const wire::CellStates& in, CellStatesMessage& out) {
  out.schema_version = in.schema_version();
  out.cell_x = in.cell_x();
  out.cell_y = in.cell_y();
  out.states.clear();
  out.states.reserve(in.states().size());
  for (const auto& state : in.states()) {
    out.states.push_back({.robot_id = state.robot_id(),
                          .sequence_number = state.sequence_number(),
                          .stamp_utc_ns = state.stamp_utc_ns(),
                          .x_m = state.x_m(),
                          .y_m = state.y_m(),
                          .vx_mps = state.vx_mps(),
                          .vy_mps = state.vy_mps(),
                          .mode = static_cast<RobotMode>(state.mode())});
  }
}

bool to_wire(const CommandMessage& in, wire::Command& out) {
  out.schema_version(in.schema_version);
  out.kind(static_cast<std::uint8_t>(in.kind));
  out.command_id(in.command_id);
  out.stamp_utc_ns(in.stamp_utc_ns);
  return true;
}

void from_wire(const wire::Command& in, CommandMessage& out) {
  out.schema_version = in.schema_version();
  out.kind = static_cast<CommandKind>(in.kind());
  out.command_id = in.command_id();
  out.stamp_utc_ns = in.stamp_utc_ns();
}

bool to_wire(const StatusMessage& in, wire::Status& out) {
  if (!fits_wire(in)) return false;
  out.first_robot_id(in.first_robot_id);
  out.schema_version(in.schema_version);
  out.process_id(in.process_id);
  out.plan_version(in.plan_version);
  out.plan_epoch(in.plan_epoch);
  out.plan_scene_version(in.plan_scene_version);
  out.stamp_utc_ns(in.stamp_utc_ns);
  out.plan_time_s(in.plan_time_s);
  out.robots().resize(in.robots.size());
  for (std::size_t i = 0; i < in.robots.size(); ++i) {
    const RobotStatusMessage& robot = in.robots[i];
    wire::RobotStatus& wired = out.robots()[i];
    wired.robot_id(robot.robot_id);
    wired.mode(static_cast<std::uint8_t>(robot.mode));
    wired.arrived(robot.arrived);
    wired.settled(robot.settled);
    wired.x_m(robot.x_m);
    wired.y_m(robot.y_m);
    wired.remaining_m(robot.remaining_m);
    wired.lag_s(robot.lag_s);
    wired.nearest_gap_m(robot.nearest_gap_m);
    wired.neighbours_heard(robot.neighbours_heard);
    wired.ticks(robot.ticks);
    wired.late_ticks(robot.late_ticks);
    wired.states_sent(robot.states_sent);
    wired.states_received(robot.states_received);
  }
  out.refused(in.refused);
  out.state_age().resize(in.state_age.size());
  for (std::size_t i = 0; i < in.state_age.size(); ++i) {
    out.state_age()[i].bin(in.state_age[i].bin);
    out.state_age()[i].count(in.state_age[i].count);
  }
  return true;
}

void from_wire(const wire::Status& in, StatusMessage& out) {
  out.first_robot_id = in.first_robot_id();
  out.schema_version = in.schema_version();
  out.process_id = in.process_id();
  out.plan_version = in.plan_version();
  out.plan_epoch = in.plan_epoch();
  out.plan_scene_version = in.plan_scene_version();
  out.stamp_utc_ns = in.stamp_utc_ns();
  out.plan_time_s = in.plan_time_s();
  out.robots.clear();
  out.robots.reserve(in.robots().size());
  for (const wire::RobotStatus& robot : in.robots()) {
    out.robots.push_back({.robot_id = robot.robot_id(),
                          .mode = static_cast<RobotMode>(robot.mode()),
                          .arrived = robot.arrived(),
                          .settled = robot.settled(),
                          .x_m = robot.x_m(),
                          .y_m = robot.y_m(),
                          .remaining_m = robot.remaining_m(),
                          .lag_s = robot.lag_s(),
                          .nearest_gap_m = robot.nearest_gap_m(),
                          .neighbours_heard = robot.neighbours_heard(),
                          .ticks = robot.ticks(),
                          .late_ticks = robot.late_ticks(),
                          .states_sent = robot.states_sent(),
                          .states_received = robot.states_received()});
  }
  out.refused = in.refused();
  out.state_age.clear();
  out.state_age.reserve(in.state_age().size());
  for (const auto& bin : in.state_age()) {
    out.state_age.push_back({.bin = bin.bin(), .count = bin.count()});
  }
}

bool to_wire(const EventMessage& in, wire::Event& out) {
  out.schema_version(in.schema_version);
  out.severity(static_cast<std::uint8_t>(in.severity));
  out.source(in.source);
  out.stamp_utc_ns(in.stamp_utc_ns);
  out.code() = in.code;
  out.text() = in.text;
  return true;
}

void from_wire(const wire::Event& in, EventMessage& out) {
  out.schema_version = in.schema_version();
  out.severity = static_cast<Severity>(in.severity());
  out.source = in.source();
  out.stamp_utc_ns = in.stamp_utc_ns();
  out.code = in.code().to_string();
  out.text = in.text().to_string();
}

}  // namespace swarm::link::cdr
