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

/// Everything a mission file says, with its defaults. One struct per top-level key, one field per
/// key of the file, the same names. Components take their own options, never the Mission.

/// A robot's body. Noise is zero-mean, Gaussian and independent per axis and control step.
struct BodySpec {
  std::string model = "single_integrator";  ///< a driver that the robots' program has
  double radius_m = 0.2;
  double speed_max_mps = 1.5;
  double acceleration_max_mps2 = 3.0;  ///< unicycle (along its heading) and double integrator
  double turn_rate_max_radps = 3.0;    ///< unicycle
  double hear_radius_m = 0.0;          ///< its sensing range; 0 = link.hear_radius_m
  double motion_noise_m = 0.0;         ///< σ of w(k) [ROVER, eq. 9]
  double position_noise_m = 0.0;       ///< σ of its measured position
  /// How long it may take until it moves at the velocity it was commanded. Unset, `auto` in the
  /// file: the reader sets it as the driver declares it, see body_lag_s().
  std::optional<double> lag_s{};
  OptionValues options{};  ///< of its driver
};

/// A number of robots that differ from the others.
struct RobotGroupSpec : BodySpec {
  std::uint32_t count = 1;
};

struct RobotsSpec : BodySpec {
  std::uint32_t count = 100;
  double placement_gap_m = 0.7;  ///< least surface gap to robots and obstacles at the start
  /// The first ids, group after group; the rest are as the keys beside it say.
  std::vector<RobotGroupSpec> groups;
};

/// The body of one robot. \pre robot < robots.count
const BodySpec& body_of(const RobotsSpec& robots, RobotId robot);
/// The largest radius of any robot [m].
double largest_radius_m(const RobotsSpec& robots);

struct PlannerSpec {
  std::string method = "swarmprm";  ///< a planning method that the planner's program has
  double risk_alpha = 0.05;         ///< α
  double risk_delta_m = -0.2;       ///< δ
  double speed_mps = 1.25;          ///< speed of the Gaussians along a route
  /// swarmprm and rover: robots/m² at most; 0 = no cap. Unset, `auto` in the file: swarmprm plans
  /// at a density and a speed that the bodies can follow (body_limits.hpp), the others without a
  /// cap.
  std::optional<double> density_cap_per_m2;
  OptionValues options{};  ///< of the planning methods, which declare them
};

struct ControlSpec {
  std::string method = "apf";  ///< a control method that the robots' program has
  double rate_hz = 10.0;
  double cruise_mps = 1.45;  ///< largest desired speed along the path
  OptionValues options{};    ///< of the control methods, which declare them
};

struct SafetySpec {
  double gap_share = 0.5;            ///< γ: share of the gap a robot may close by one command
  double stale_gain = 1.0;           ///< a: how much slower by what is known late
  double neighbour_margin_m = 0.25;  ///< m
  double obstacle_margin_m = 0.05;   ///< m_o
  double follow_share = 0.8;         ///< β: how much of a neighbour's retreat may be used
};

struct LinkSpec {
  double cell_size_m = 100.0;        ///< of the topics channel
  double hear_radius_m = 4.0;        ///< states of robots this near must be heard
  double join_margin_m = 6.0;        ///< a cell is joined this much before it is needed
  double leave_margin_m = 9.0;       ///< and left this much after
  double group_cell_size_m = 5.0;    ///< of the groups channel, whose cells cost no discovery
  double send_error_m = 0.05;        ///< dead reckoning: speak when extrapolation is off by this
  double send_interval_max_s = 0.5;  ///< … or this old
  double send_near_m = 1.0;          ///< … or, on a poor link, while a surface is this near
  double status_hz = 1.0;
};

struct TimingSpec {
  double heartbeat_hz = 5.0;
  double planner_silence_s = 2.0;   ///< silent planner → hold, avoidance on
  double neighbour_forget_s = 2.0;  ///< until then its radius grows by v_max · age
  double clock_skew_warn_s = 0.25;
  double clock_skew_refuse_s = 10.0;
};

/// The plan's clock τ: how far it slows down when the swarm falls behind the plan.
struct PlanClockSpec {
  double lag_quantile = 0.75;    ///< of the robots' lags; the clock looks at this one
  double lag_free_s = 2.0;       ///< up to this lag τ advances with time
  double lag_stop_s = 8.0;       ///< at this lag it would stand still, were there no least rate
  double rate_min = 0.2;         ///< τ advances at least this fast; 1 = the clock never slows down
  double hopeless_lag_s = 30.0;  ///< robots later than this do not slow it down; they are named
};

struct LauncherSpec {
  double starts_per_s = 60.0;
  std::uint32_t starting_max = 8;  ///< processes started and not heard yet
  double quorum_share = 1.0;       ///< after the time-out this share of robots is enough
  double quorum_timeout_s = 30.0;  ///< until then all are waited for; the missing are named
  double time_limit_s = 600.0;     ///< of mission time
  std::uint32_t respawn_planner_max = 3;
  std::uint32_t respawn_agent_max = 0;
};

/// What the audit demands of a run beyond arrival and no contact. A bar that is not set is not
/// judged; one whose quantity cannot be computed from the run fails it. The quantities and how they
/// are measured: swarm_monitor/tracking/tracking.hpp.
struct CriteriaSpec {
  using Bar = std::optional<double>;
  Bar w2_ratio_max{};       ///< mean W2 of swarm and χ(τ) over the mean floor of sampling
  Bar w2_half_ratio_max{};  ///< the same while at most half of the robots have arrived
  Bar w2_end_ratio_max{};   ///< W2 of the last positions to the goal mixture over its floor
  Bar centre_lag_max_s{};   ///< amount of the signed lag of the swarm's centre
  Bar lag_p90_max_s{};      ///< 90 % of the amounts of the robots' signed lags
  Bar lag_p99_max_s{};
  Bar clock_error_max_s{};    ///< amount by which a robot's τ differs from the published one
  Bar reference_p50_max_m{};  ///< distance of robots under way to their own references
  Bar reference_p95_max_m{};
  Bar reference_rms_max_m{};
  Bar density_over_cap_p95_max{};  ///< flown peak over the cap, minus 1, at 95 % of times
  Bar density_over_cap_max{};      ///< … always
  Bar planned_over_cap_max{};      ///< planned peak over the cap, minus 1, always
  Bar cvar_kept_share_min{};  ///< share of times with the executed CVaR ≤ planner.risk_delta_m
  Bar own_place_share_min{};  ///< share of robots within 0.7 m of their last reference
  Bar path_ratio_max{};       ///< mean path over the geodesic bound
  Bar mission_over_plan_max_s{};  ///< mission time minus the first plan's duration
  Bar arrival_spread_max_s{};     ///< from 5 % to 95 % of the arrival times
};

struct Mission;
/// The largest sensing range of any robot [m].
double hears_farthest_m(const Mission& mission);

/// What script and user may ask of a running mission: a command to all, or a change of the scene.
using MissionAction = std::variant<CommandKind, SceneChange>;

struct ScriptEvent {
  double at_s = 0.0;  ///< mission time
  MissionAction action = CommandKind::kPause;
};

struct Mission {
  std::string name = "mission";
  World world;
  RobotsSpec robots;
  Mixture start;
  Mixture goal;
  std::shared_ptr<const ShapeField> goal_shape;  ///< the drawing `goal` was fitted to; null = none
  PlannerSpec planner;
  ControlSpec control;
  SafetySpec safety;
  LinkSpec link;
  TimingSpec timing;
  PlanClockSpec plan_clock;
  LauncherSpec launcher;
  CriteriaSpec criteria;
  std::vector<ScriptEvent> script;  ///< ordered by at_s
};

}  // namespace swarm
