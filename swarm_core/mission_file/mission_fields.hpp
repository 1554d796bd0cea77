// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <variant>

#include "swarm_core/mission_file/yaml_reader.hpp"
#include "swarmflow/mission/mission.hpp"

/// The scalar keys that belong to the mission and to the programs that run it, section by section,
/// each with the numbers it accepts and one line of documentation. The keys of components are in
/// their own option tables, beside their code.
namespace swarm::mission_fields {

/// One key of a section: the member it sets, the numbers it accepts, and what it means. An optional
/// number is written back only where it is set.
template <class Section>
struct Field {
  std::string_view key;
  std::variant<double Section::*, std::uint32_t Section::*, std::optional<double> Section::*>
      member;
  yaml::Range range;
  std::string_view doc;  ///< one line
};

using swarm::between;
using swarm::positive;

/// Bound of coordinates and sizes: a larger world is a mistake of units.
inline constexpr double kMaxExtent_m = 1e6;
inline constexpr yaml::Range kCoordinate_m = between(-kMaxExtent_m, kMaxExtent_m);  ///< x or y
inline constexpr double kMaxRobots = 200'000;           ///< of the swarm
inline constexpr std::size_t kMaxRobotGroups = 64;      ///< with bodies of their own
inline constexpr std::size_t kMaxComponents = 255;      ///< a robot log names goals by one byte
inline constexpr std::size_t kMaxObstacles = 10'000;    ///< of the world
inline constexpr std::size_t kMaxVertices = 100'000;    ///< of all polygons together
inline constexpr std::size_t kMaxScriptEvents = 1'000;  ///< of the mission's script
inline constexpr std::size_t kMaxNameLength = 64;       ///< of the mission, in bytes
/// Values of `action` in a script: commands first, then changes of the scene.
inline constexpr std::array<std::string_view, 9> kScriptActions{
    "pause",           "resume", "stop", "add_obstacle", "move_obstacle",
    "remove_obstacle", "goto",   "risk", "clear"};
inline constexpr yaml::Range kDensityCap_per_m2 = between(0, 1e6);  ///< or kAutomatic
inline constexpr yaml::Range kLag_s = between(0, 60);               ///< or kAutomatic
inline constexpr std::string_view kAutomatic = "auto";              ///< chosen by the program
/// Ranges that several readers share.
inline constexpr yaml::Range kRiskAlpha = between(1e-6, 1 - 1e-6);
inline constexpr yaml::Range kScriptTime_s = between(0.0, 1e6);

/// Of the swarm as a whole.
inline constexpr std::array<Field<RobotsSpec>, 2> kRobots{{
    {"count", &RobotsSpec::count, between(1, kMaxRobots), "robots of the swarm"},
    {"placement_gap_m", &RobotsSpec::placement_gap_m, between(0, 100),
     "least surface gap to robots and obstacles at the start"},
}};

/// Of the body of all robots and of each group of robots.
inline constexpr std::array<Field<BodySpec>, 7> kBody{{
    {"radius_m", &BodySpec::radius_m, positive(100), "of the body"},
    {"speed_max_mps", &BodySpec::speed_max_mps, positive(100), "largest speed of the body"},
    {"acceleration_max_mps2", &BodySpec::acceleration_max_mps2, positive(1000),
     "unicycle (along its heading) and double_integrator"},
    {"turn_rate_max_radps", &BodySpec::turn_rate_max_radps, positive(1000), "unicycle"},
    {"communication_radius_m", &BodySpec::communication_radius_m, between(0, 10'000),
     "its communication radius; 0: link.communication_radius_m"},
    {"motion_noise_m", &BodySpec::motion_noise_m, between(0, 100),
     "standard deviation of what a control step adds to the motion, per axis"},
    {"position_noise_m", &BodySpec::position_noise_m, between(0, 100),
     "standard deviation of the measured position, per axis"},
}};

/// What every planning method reads.
inline constexpr std::array<Field<PlannerSpec>, 3> kPlanner{{
    {"risk_alpha", &PlannerSpec::risk_alpha, kRiskAlpha,
     "alpha of the risk limit CVaR_alpha <= delta"},
    {"risk_delta_m", &PlannerSpec::risk_delta_m, between(-1000, 0), "delta of the risk limit"},
    {"speed_mps", &PlannerSpec::speed_mps, positive(100), "speed of the Gaussians along a route"},
}};

/// What every control method reads.
inline constexpr std::array<Field<ControlSpec>, 2> kControl{{
    {"rate_hz", &ControlSpec::rate_hz, between(0.5, 1000), "control steps per second"},
    {"cruise_mps", &ControlSpec::cruise_mps, positive(100), "largest desired speed along the path"},
}};

/// Of the safety filter, which limits every commanded velocity.
inline constexpr std::array<Field<SafetySpec>, 5> kSafety{{
    {"gap_share", &SafetySpec::gap_share, positive(1),
     "share of the gap that a robot may close by one command"},
    {"stale_gain", &SafetySpec::stale_gain, between(0, 100),
     "how much slower by what is known late"},
    {"neighbour_margin_m", &SafetySpec::neighbour_margin_m, between(0, 100),
     "surface gap that robots keep to each other"},
    {"obstacle_margin_m", &SafetySpec::obstacle_margin_m, between(0, 100),
     "surface gap that robots keep to obstacles"},
    {"follow_share", &SafetySpec::follow_share, between(0, 1),
     "how much of a neighbour's retreat may be used"},
}};

/// Of the exchange of state updates between robots.
inline constexpr std::array<Field<LinkSpec>, 9> kLink{{
    {"cell_size_m", &LinkSpec::cell_size_m, between(1, 10'000), "cells of the topics channel"},
    {"communication_radius_m", &LinkSpec::communication_radius_m, positive(10'000),
     "states of robots this near are received"},
    {"join_margin_m", &LinkSpec::join_margin_m, between(0, 1000),
     "a cell is joined this much before it is needed"},
    {"leave_margin_m", &LinkSpec::leave_margin_m, between(0, 1000), "and left this much after"},
    {"group_cell_size_m", &LinkSpec::group_cell_size_m, between(1, 10'000),
     "cells of the groups channel, which cost no discovery"},
    {"send_error_m", &LinkSpec::send_error_m, between(0, 100),
     "dead reckoning: a state is sent when its extrapolation is off by this"},
    {"send_interval_max_s", &LinkSpec::send_interval_max_s, positive(60), "or this old"},
    {"send_near_m", &LinkSpec::send_near_m, between(0, 10'000),
     "or, on a degraded link, while a surface is this near"},
    {"status_hz", &LinkSpec::status_hz, between(0.01, 100), "status messages per second"},
}};

/// Timeouts, and the clock differences that are accepted between hosts.
inline constexpr std::array<Field<TimingSpec>, 5> kTiming{{
    {"heartbeat_hz", &TimingSpec::heartbeat_hz, between(2, 1000),
     "the planner's heartbeats per second"},
    {"planner_silence_s", &TimingSpec::planner_silence_s, positive(3600),
     "robots hold, avoidance on, without a heartbeat for this long"},
    {"neighbour_forget_s", &TimingSpec::neighbour_forget_s, positive(60),
     "until then the radius of a silent neighbour grows by v_max times its age"},
    {"clock_skew_warn_s", &TimingSpec::clock_skew_warn_s, positive(3600),
     "clocks that differ by more are warned about"},
    {"clock_skew_refuse_s", &TimingSpec::clock_skew_refuse_s, positive(3600),
     "messages of clocks that differ by more are refused"},
}};

/// Of the plan's clock, which slows down while the swarm lags behind the plan.
inline constexpr std::array<Field<PlanClockSpec>, 5> kPlanClock{{
    {"lag_quantile", &PlanClockSpec::lag_quantile, between(0.5, 1),
     "of the robots' lags; the plan's clock looks at this one"},
    {"lag_free_s", &PlanClockSpec::lag_free_s, between(0, 3600),
     "up to this lag the plan's clock advances with time"},
    {"lag_stop_s", &PlanClockSpec::lag_stop_s, positive(3600),
     "at this lag it would stand still, were there no least rate"},
    {"rate_min", &PlanClockSpec::rate_min, between(0.01, 1),
     "it advances at least this fast; 1: it never slows down"},
    {"hopeless_lag_s", &PlanClockSpec::hopeless_lag_s, positive(1e6),
     "robots later than this do not slow it down; they are named"},
}};

/// Of the start and the supervision of processes.
inline constexpr std::array<Field<LauncherSpec>, 7> kLauncher{{
    {"starts_per_s", &LauncherSpec::starts_per_s, positive(10'000),
     "processes started per second at most"},
    {"starting_max", &LauncherSpec::starting_max, between(1, 10'000),
     "processes started and not received yet at most"},
    {"quorum_share", &LauncherSpec::quorum_share, positive(1),
     "after the time-out this share of robots is enough"},
    {"quorum_timeout_s", &LauncherSpec::quorum_timeout_s, positive(3600),
     "until then all robots are waited for; the missing are named"},
    {"time_limit_s", &LauncherSpec::time_limit_s, positive(1e6), "of mission time"},
    {"respawn_planner_max", &LauncherSpec::respawn_planner_max, between(0, 1000),
     "times that a planner which ended is started again"},
    {"respawn_agent_max", &LauncherSpec::respawn_agent_max, between(0, 1000),
     "times that a robot's process which ended is started again"},
}};

/// Limits by which the audit judges a run; all of them may be left out.
inline constexpr std::array<Field<CriteriaSpec>, 18> kCriteria{{
    {"w2_ratio_max", &CriteriaSpec::w2_ratio_max, positive(1000),
     "mean W2 of swarm and plan over the mean floor of sampling"},
    {"w2_half_ratio_max", &CriteriaSpec::w2_half_ratio_max, positive(1000),
     "the same while at most half of the robots have arrived"},
    {"w2_end_ratio_max", &CriteriaSpec::w2_end_ratio_max, positive(1000),
     "W2 of the last positions to the goal mixture over its floor"},
    {"centre_lag_max_s", &CriteriaSpec::centre_lag_max_s, positive(3600),
     "amount of the signed lag of the swarm's centre"},
    {"lag_p90_max_s", &CriteriaSpec::lag_p90_max_s, positive(3600),
     "90 % of the amounts of the robots' signed lags"},
    {"lag_p99_max_s", &CriteriaSpec::lag_p99_max_s, positive(3600),
     "99 % of the amounts of the robots' signed lags"},
    {"clock_error_max_s", &CriteriaSpec::clock_error_max_s, positive(3600),
     "amount by which a robot's plan time differs from the published one"},
    {"reference_p50_max_m", &CriteriaSpec::reference_p50_max_m, positive(kMaxExtent_m),
     "distance of robots under way to their own references, median"},
    {"reference_p95_max_m", &CriteriaSpec::reference_p95_max_m, positive(kMaxExtent_m),
     "the same, 95 % of them"},
    {"reference_rms_max_m", &CriteriaSpec::reference_rms_max_m, positive(kMaxExtent_m),
     "the same, root of the mean square"},
    {"density_over_cap_p95_max", &CriteriaSpec::density_over_cap_p95_max, between(-1, 1000),
     "flown peak density over the cap, minus 1, at 95 % of times"},
    {"density_over_cap_max", &CriteriaSpec::density_over_cap_max, between(-1, 1000),
     "the same, always"},
    {"planned_over_cap_max", &CriteriaSpec::planned_over_cap_max, between(-1, 1000),
     "planned peak density over the cap, minus 1, always"},
    {"cvar_kept_share_min", &CriteriaSpec::cvar_kept_share_min, between(0, 1),
     "share of times with the executed CVaR <= planner.risk_delta_m"},
    {"own_place_share_min", &CriteriaSpec::own_place_share_min, between(0, 1),
     "share of robots within 0.7 m of their last reference"},
    {"path_ratio_max", &CriteriaSpec::path_ratio_max, positive(1000),
     "mean path over the geodesic bound"},
    {"mission_over_plan_max_s", &CriteriaSpec::mission_over_plan_max_s, between(-1e6, 1e6),
     "mission time minus the first plan's duration"},
    {"arrival_spread_max_s", &CriteriaSpec::arrival_spread_max_s, positive(1e6),
     "from 5 % to 95 % of the arrival times"},
}};

}  // namespace swarm::mission_fields
