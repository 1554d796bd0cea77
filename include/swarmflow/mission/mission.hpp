// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "swarmflow/core/cvar.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/shape_field.hpp"
#include "swarmflow/core/world.hpp"
#include "swarmflow/mission/options.hpp"
#include "swarmflow/mission/phase.hpp"
#include "swarmflow/mission/scene.hpp"

namespace swarm {

// The content of a mission file, with its defaults: one struct per top-level key, one member per
// key of the file, the same names. Ranges are checked when a file is read. Components take their
// own options, never the Mission.

/// A robot's body. Noise is zero-mean, Gaussian and independent per axis and control step.
struct BodySpec {
  std::string model = "single_integrator";  ///< name of a driver that the robots' program has
  double radius_m = 0.2;                    ///< radius of the disc that covers it
  double speed_max_mps = 1.5;               ///< its largest speed [m/s]
  double acceleration_max_mps2 = 3.0;  ///< of unicycle (along its heading) and double integrator
  double turn_rate_max_radps = 3.0;    ///< of unicycle [rad/s]
  double communication_radius_m =
      0.0;                        ///< its communication radius; 0: link.communication_radius_m
  double motion_noise_m = 0.0;    ///< σ of w(k) per control step [ROVER, eq. 9]
  double position_noise_m = 0.0;  ///< σ of its measured position [m]
  /// Longest time that it takes to reach a commanded velocity [s]. Unset, `auto` in the file: the
  /// reader sets it as the driver declares it, see body_lag_s().
  std::optional<double> lag_s{};
  OptionValues options{};  ///< options that its driver declares
};

/// A number of robots that differ from the others.
struct RobotGroupSpec : BodySpec {
  std::uint32_t count = 1;  ///< number of robots with this body
};

/// Key `robots`: the swarm; its own BodySpec holds for robots outside of groups.
struct RobotsSpec : BodySpec {
  std::uint32_t count = 100;     ///< number of robots, N
  double placement_gap_m = 0.7;  ///< least gap between surfaces at the start [m]
  /// Groups with other bodies: they have the first ids, group after group.
  std::vector<RobotGroupSpec> groups;
};

/// The body of one robot; a reference into `robots`. O(groups). \pre robot < robots.count, asserted
const BodySpec& body_of(const RobotsSpec& robots, RobotId robot);
/// The largest radius of any robot [m]. O(groups).
double largest_radius_m(const RobotsSpec& robots);

/// Key `planner`: the planning method, and the options of the built-in ones.
struct PlannerSpec {
  std::string method = "swarmprm";  ///< name of a planning method that the planner's program has
  double risk_alpha = 0.05;         ///< α of RiskLimit
  double risk_delta_m = -0.2;       ///< δ of RiskLimit [m]
  double speed_mps = 1.25;          ///< speed of the means along a route [m/s]
  /// swarmprm and rover: density cap [robots/m²]; 0: no cap. Empty, `auto` in the file: swarmprm
  /// plans at a density and a speed that the bodies can follow (body_limits.hpp), the others plan
  /// without a cap.
  std::optional<double> density_cap_per_m2;
  OptionValues options{};  ///< options that the planning methods declare
};

/// Key `control`: the control method, and the options of the built-in ones.
struct ControlSpec {
  std::string method = "apf";  ///< name of a control method that the robots' program has
  double rate_hz = 10.0;       ///< rate of the control loop, 1/Δt
  double cruise_mps = 1.45;    ///< largest desired speed along the path [m/s]
  OptionValues options{};      ///< options that the control methods declare
};

/// Key `safety`: the safety filter between every control method and the driver.
struct SafetySpec {
  double gap_share = 0.5;            ///< γ: share of the gap a robot may close by one command
  double stale_gain = 1.0;           ///< a: extra closing time per information age
  double neighbour_margin_m = 0.25;  ///< m: gap kept to other robots [m]
  double obstacle_margin_m = 0.05;   ///< m_o: gap kept to obstacles and bounds [m]
  double follow_share = 0.8;         ///< β: usable share of a neighbour's retreating speed
};

/// Key `link`: which states are received, and when they are published.
struct LinkSpec {
  double cell_size_m = 100.0;           ///< side of a cell of the topics channel [m]
  double communication_radius_m = 4.0;  ///< communication radius [m]
  double join_margin_m = 6.0;           ///< a cell is joined this much before it is needed [m]
  double leave_margin_m = 9.0;          ///< and left this much after [m]
  double group_cell_size_m = 5.0;       ///< side of a cell of the groups channel [m]
  double send_error_m = 0.05;           ///< a state is published when extrapolation is off by this
  double send_interval_max_s = 0.5;     ///< … or when the last one is this old
  double send_near_m = 1.0;  ///< … or, on a degraded link, while a surface is this near
  double status_hz = 1.0;    ///< rate of a robot's statuses
};

/// Key `timing`: timeouts between processes.
struct TimingSpec {
  double heartbeat_hz = 5.0;          ///< rate of the planner's heartbeats
  double planner_silence_s = 2.0;     ///< robots hold after this time without a heartbeat
  double neighbour_forget_s = 2.0;    ///< a neighbour is forgotten after this time without a state
  double clock_skew_warn_s = 0.25;    ///< stamps off by more are reported
  double clock_skew_refuse_s = 10.0;  ///< messages from further in the future are refused
};

/// The plan's clock τ: how far it slows down when the swarm falls behind the plan.
struct PlanClockSpec {
  double lag_quantile = 0.75;    ///< quantile L of the robots' lags that sets the rate
  double lag_free_s = 2.0;       ///< L₀: up to this lag τ advances with time
  double lag_stop_s = 8.0;       ///< L₁: lag at which the rate would be 0 without rate_min
  double rate_min = 0.2;         ///< least dτ/dt; 1: the clock never slows down
  double hopeless_lag_s = 30.0;  ///< robots later than this do not count; they are reported
};

/// Key `launcher`: start and end of a run's processes.
struct LauncherSpec {
  double starts_per_s = 60.0;      ///< rate of process starts
  std::uint32_t starting_max = 8;  ///< most processes started but not received yet
  double quorum_share = 1.0;       ///< share of robots that is enough after the timeout
  double quorum_timeout_s = 30.0;  ///< until then all are waited for; missing ones are reported
  double time_limit_s = 600.0;     ///< longest mission time
  std::uint32_t respawn_planner_max = 3;  ///< most restarts of the planner
  std::uint32_t respawn_agent_max = 0;    ///< most restarts of each agent process
};

/// Key `criteria`: what the audit demands of a run beyond arrival and no contact. A bar that is not
/// set is not judged; one whose quantity cannot be computed from the run fails it. The quantities
/// and how they are measured: "Tracking" in docs/architecture.md.
struct CriteriaSpec {
  /// A limit; empty: not judged.
  using Bar = std::optional<double>;
  Bar w2_ratio_max{};              ///< mean W2 of swarm and χ(τ) over the mean floor of sampling
  Bar w2_half_ratio_max{};         ///< the same while at most half of the robots have arrived
  Bar w2_end_ratio_max{};          ///< W2 of the last positions to the goal mixture over its floor
  Bar centre_lag_max_s{};          ///< amount of the signed lag of the swarm's centre
  Bar lag_p90_max_s{};             ///< 90 % of the amounts of the robots' signed lags
  Bar lag_p99_max_s{};             ///< the same for 99 %
  Bar clock_error_max_s{};         ///< amount by which a robot's τ differs from the published one
  Bar reference_p50_max_m{};       ///< median distance of robots under way to their references
  Bar reference_p95_max_m{};       ///< 95 % of these distances
  Bar reference_rms_max_m{};       ///< root mean square of these distances
  Bar density_over_cap_p95_max{};  ///< flown peak over the cap, minus 1, at 95 % of times
  Bar density_over_cap_max{};      ///< the same at all times
  Bar planned_over_cap_max{};      ///< planned peak over the cap, minus 1, at all times
  Bar cvar_kept_share_min{};  ///< share of times with the executed CVaR ≤ planner.risk_delta_m
  Bar own_place_share_min{};  ///< share of robots within 0.7 m of their last reference
  Bar path_ratio_max{};       ///< mean path over the geodesic bound
  Bar mission_over_plan_max_s{};  ///< mission time minus the first plan's duration
  Bar arrival_spread_max_s{};     ///< from 5 % to 95 % of the arrival times
};

struct Mission;
/// The largest communication radius of any robot [m]. O(groups).
double largest_communication_radius_m(const Mission& mission);

/// What script and operator may do to a running mission: a command to all, or a scene change.
using MissionAction = std::variant<CommandKind, SceneChange>;

/// One entry of key `script`.
struct ScriptEvent {
  double at_s = 0.0;                           ///< mission time at which it is due [s]
  MissionAction action = CommandKind::kPause;  ///< what is done then
};

/// A whole mission, as load_mission() reads it.
struct Mission {
  std::string name = "mission";                  ///< 1 to 64 letters, digits, _ - .
  World world;                                   ///< map at the start
  RobotsSpec robots;                             ///< the swarm
  Mixture start;                                 ///< where it starts
  Mixture goal;                                  ///< where it is to be
  std::shared_ptr<const ShapeField> goal_shape;  ///< the drawing `goal` was fitted to; null: none
  PlannerSpec planner;                           ///< planning method and options
  ControlSpec control;                           ///< control method and options
  SafetySpec safety;                             ///< safety filter
  LinkSpec link;                                 ///< communication
  TimingSpec timing;                             ///< timeouts
  PlanClockSpec plan_clock;                      ///< the plan's clock
  LauncherSpec launcher;                         ///< processes
  CriteriaSpec criteria;                         ///< bars of the audit
  std::vector<ScriptEvent> script;               ///< scripted actions, by ascending at_s
};

}  // namespace swarm
