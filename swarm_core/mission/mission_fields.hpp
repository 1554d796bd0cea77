// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <variant>

#include "swarmflow/mission/mission.hpp"
#include "swarm_core/mission/yaml_reader.hpp"

/// The scalar keys of each section with the numbers they accept: said once, used by the reader, the
/// writer and the tests.
namespace swarm::mission_fields {

/// A number that may be left out is written back only where it is set.
template <class Section>
struct Field {
  std::string_view key;
  std::variant<double Section::*, std::uint32_t Section::*, std::optional<double> Section::*>
      member;
  yaml::Range range;
};

using swarm::between;
using swarm::positive;

/// Coordinates and sizes: beyond this it is no place robots of this size drive in.
inline constexpr double kMaxExtent_m = 1e6;
inline constexpr double kMaxRobots = 200'000;
inline constexpr std::size_t kMaxRobotGroups = 64;
inline constexpr std::size_t kMaxComponents = 255;  ///< a black box names goals by one byte
inline constexpr std::size_t kMaxObstacles = 10'000;
inline constexpr std::size_t kMaxVertices = 100'000;  ///< of all polygons together
inline constexpr std::size_t kMaxScriptEvents = 1'000;
inline constexpr std::size_t kMaxNameLength = 64;
inline constexpr std::array<std::string_view, 4> kPlannerMethods{"swarmprm", "rover", "crops",
                                                                 "adoc"};
inline constexpr std::array<std::string_view, 3> kPlannerSamplers{"fit", "halton", "uniform"};
inline constexpr std::array<std::string_view, 2> kDensityCaps{"timed", "static"};
inline constexpr std::array<std::string_view, 3> kControlMethods{"apf", "crops",
                                                                 "intermittent_diffusion"};
inline constexpr std::array<std::string_view, 2> kTracking{"plan", "free"};
inline constexpr std::array<std::string_view, 3> kRobotModels{"single_integrator", "unicycle",
                                                              "double_integrator"};
inline constexpr std::array<std::string_view, 9> kScriptActions{
    "pause",           "resume", "stop", "add_obstacle", "move_obstacle",
    "remove_obstacle", "goto",   "risk", "clear"};
inline constexpr yaml::Range kDensityCap_per_m2 = between(0, 1e6);  ///< or kAutomatic
inline constexpr std::string_view kAutomatic = "auto";
inline constexpr yaml::Range kRiskAlpha = between(1e-6, 1 - 1e-6);
inline constexpr yaml::Range kScriptTime_s = between(0.0, 1e6);

inline constexpr std::array<Field<RobotsSpec>, 2> kRobots{{
    {"count", &RobotsSpec::count, between(1, kMaxRobots)},
    {"placement_gap_m", &RobotsSpec::placement_gap_m, between(0, 100)},
}};

/// Of robots and of each of its groups.
inline constexpr std::array<Field<BodySpec>, 7> kBody{{
    {"radius_m", &BodySpec::radius_m, positive(100)},
    {"speed_max_mps", &BodySpec::speed_max_mps, positive(100)},
    {"acceleration_max_mps2", &BodySpec::acceleration_max_mps2, positive(1000)},
    {"turn_rate_max_radps", &BodySpec::turn_rate_max_radps, positive(1000)},
    {"hear_radius_m", &BodySpec::hear_radius_m, between(0, 10'000)},
    {"motion_noise_m", &BodySpec::motion_noise_m, between(0, 100)},
    {"position_noise_m", &BodySpec::position_noise_m, between(0, 100)},
}};

inline constexpr std::array<Field<PlannerSpec>, 20> kPlanner{{
    {"samples", &PlannerSpec::samples, between(1, 100'000)},
    {"connection_radius_m", &PlannerSpec::connection_radius_m, positive(kMaxExtent_m)},
    {"risk_alpha", &PlannerSpec::risk_alpha, kRiskAlpha},
    {"risk_delta_m", &PlannerSpec::risk_delta_m, between(-1000, 0)},
    {"sigma_min_m", &PlannerSpec::sigma_min_m, between(0.01, 1000)},
    {"sigma_max_m", &PlannerSpec::sigma_max_m, between(0.01, 1000)},
    {"rho_max", &PlannerSpec::rho_max, between(0, 0.99)},
    {"bridge_share", &PlannerSpec::bridge_share, between(0, 1)},
    {"bridge_sigma_m", &PlannerSpec::bridge_sigma_m, positive(kMaxExtent_m)},
    {"shortcuts", &PlannerSpec::shortcuts, between(0, 1'000'000)},
    {"speed_mps", &PlannerSpec::speed_mps, positive(100)},
    {"collocation_spacing_m", &PlannerSpec::collocation_spacing_m, positive(kMaxExtent_m)},
    {"collocation_sigma_m", &PlannerSpec::collocation_sigma_m, between(0.01, 1000)},
    {"transport_radius_m", &PlannerSpec::transport_radius_m, positive(kMaxExtent_m)},
    {"horizon", &PlannerSpec::horizon, between(1, 10)},
    {"replan_period_s", &PlannerSpec::replan_period_s, between(0.1, 3600)},
    {"adoc_penalty", &PlannerSpec::adoc_penalty, between(0, 1e6)},
    {"crops_clearance_m", &PlannerSpec::crops_clearance_m, between(0, 1000)},
    {"crops_power", &PlannerSpec::crops_power, between(0, 10)},
    {"crops_goal_radius_m", &PlannerSpec::crops_goal_radius_m, between(0.1, 1000)},
}};

inline constexpr std::array<Field<ControlSpec>, 21> kControl{{
    {"rate_hz", &ControlSpec::rate_hz, between(0.5, 1000)},
    {"cruise_mps", &ControlSpec::cruise_mps, positive(100)},
    {"look_ahead_s", &ControlSpec::look_ahead_s, between(0, 600)},
    {"pace_gain_hz", &ControlSpec::pace_gain_hz, between(0, 100)},
    {"keep_clearance_m", &ControlSpec::keep_clearance_m, between(0, 100)},
    {"density_push_mps", &ControlSpec::density_push_mps, between(0, 100)},
    {"neighbour_gap_m", &ControlSpec::neighbour_gap_m, between(0, 100)},
    {"neighbour_push_mps", &ControlSpec::neighbour_push_mps, between(0, 100)},
    {"obstacle_gap_m", &ControlSpec::obstacle_gap_m, between(0, 100)},
    {"obstacle_push_mps", &ControlSpec::obstacle_push_mps, between(0, 100)},
    {"approach_gain_hz", &ControlSpec::approach_gain_hz, positive(1000)},
    {"stuck_after_s", &ControlSpec::stuck_after_s, positive(3600)},
    {"escape_spread_m", &ControlSpec::escape_spread_m, between(0, 1000)},
    {"escape_s", &ControlSpec::escape_s, between(0, 600)},
    {"diffusion_strength_m2", &ControlSpec::diffusion_strength_m2, positive(1000)},
    {"diffusion_range_m", &ControlSpec::diffusion_range_m, between(0, 1000)},
    {"diffusion_tolerance_m2", &ControlSpec::diffusion_tolerance_m2, positive(1000)},
    {"diffusion_gain_hz", &ControlSpec::diffusion_gain_hz, positive(1000)},
    {"diffusion_flow_s", &ControlSpec::diffusion_flow_s, positive(3600)},
    {"diffusion_noise_mps05", &ControlSpec::diffusion_noise_mps05, between(0, 1000)},
    {"diffusion_time_s", &ControlSpec::diffusion_time_s, between(0, 3600)},
}};

inline constexpr std::array<Field<SafetySpec>, 5> kSafety{{
    {"gap_share", &SafetySpec::gap_share, positive(1)},
    {"stale_gain", &SafetySpec::stale_gain, between(0, 100)},
    {"neighbour_margin_m", &SafetySpec::neighbour_margin_m, between(0, 100)},
    {"obstacle_margin_m", &SafetySpec::obstacle_margin_m, between(0, 100)},
    {"follow_share", &SafetySpec::follow_share, between(0, 1)},
}};

inline constexpr std::array<Field<LinkSpec>, 9> kLink{{
    {"cell_size_m", &LinkSpec::cell_size_m, between(1, 10'000)},
    {"hear_radius_m", &LinkSpec::hear_radius_m, positive(10'000)},
    {"join_margin_m", &LinkSpec::join_margin_m, between(0, 1000)},
    {"leave_margin_m", &LinkSpec::leave_margin_m, between(0, 1000)},
    {"group_cell_size_m", &LinkSpec::group_cell_size_m, between(1, 10'000)},
    {"send_error_m", &LinkSpec::send_error_m, between(0, 100)},
    {"send_interval_max_s", &LinkSpec::send_interval_max_s, positive(60)},
    {"send_near_m", &LinkSpec::send_near_m, between(0, 10'000)},
    {"status_hz", &LinkSpec::status_hz, between(0.01, 100)},
}};

inline constexpr std::array<Field<TimingSpec>, 5> kTiming{{
    {"heartbeat_hz", &TimingSpec::heartbeat_hz, between(2, 1000)},
    {"planner_silence_s", &TimingSpec::planner_silence_s, positive(3600)},
    {"neighbour_forget_s", &TimingSpec::neighbour_forget_s, positive(60)},
    {"clock_skew_warn_s", &TimingSpec::clock_skew_warn_s, positive(3600)},
    {"clock_skew_refuse_s", &TimingSpec::clock_skew_refuse_s, positive(3600)},
}};

inline constexpr std::array<Field<PlanClockSpec>, 5> kPlanClock{{
    {"lag_quantile", &PlanClockSpec::lag_quantile, between(0.5, 1)},
    {"lag_free_s", &PlanClockSpec::lag_free_s, between(0, 3600)},
    {"lag_stop_s", &PlanClockSpec::lag_stop_s, positive(3600)},
    {"rate_min", &PlanClockSpec::rate_min, between(0.01, 1)},
    {"hopeless_lag_s", &PlanClockSpec::hopeless_lag_s, positive(1e6)},
}};

inline constexpr std::array<Field<LauncherSpec>, 7> kLauncher{{
    {"starts_per_s", &LauncherSpec::starts_per_s, positive(10'000)},
    {"starting_max", &LauncherSpec::starting_max, between(1, 10'000)},
    {"quorum_share", &LauncherSpec::quorum_share, positive(1)},
    {"quorum_timeout_s", &LauncherSpec::quorum_timeout_s, positive(3600)},
    {"time_limit_s", &LauncherSpec::time_limit_s, positive(1e6)},
    {"respawn_planner_max", &LauncherSpec::respawn_planner_max, between(0, 1000)},
    {"respawn_agent_max", &LauncherSpec::respawn_agent_max, between(0, 1000)},
}};

inline constexpr std::array<Field<CriteriaSpec>, 18> kCriteria{{
    {"w2_ratio_max", &CriteriaSpec::w2_ratio_max, positive(1000)},
    {"w2_half_ratio_max", &CriteriaSpec::w2_half_ratio_max, positive(1000)},
    {"w2_end_ratio_max", &CriteriaSpec::w2_end_ratio_max, positive(1000)},
    {"centre_lag_max_s", &CriteriaSpec::centre_lag_max_s, positive(3600)},
    {"lag_p90_max_s", &CriteriaSpec::lag_p90_max_s, positive(3600)},
    {"lag_p99_max_s", &CriteriaSpec::lag_p99_max_s, positive(3600)},
    {"clock_error_max_s", &CriteriaSpec::clock_error_max_s, positive(3600)},
    {"reference_p50_max_m", &CriteriaSpec::reference_p50_max_m, positive(kMaxExtent_m)},
    {"reference_p95_max_m", &CriteriaSpec::reference_p95_max_m, positive(kMaxExtent_m)},
    {"reference_rms_max_m", &CriteriaSpec::reference_rms_max_m, positive(kMaxExtent_m)},
    {"density_over_cap_p95_max", &CriteriaSpec::density_over_cap_p95_max, between(-1, 1000)},
    {"density_over_cap_max", &CriteriaSpec::density_over_cap_max, between(-1, 1000)},
    {"planned_over_cap_max", &CriteriaSpec::planned_over_cap_max, between(-1, 1000)},
    {"cvar_kept_share_min", &CriteriaSpec::cvar_kept_share_min, between(0, 1)},
    {"own_place_share_min", &CriteriaSpec::own_place_share_min, between(0, 1)},
    {"path_ratio_max", &CriteriaSpec::path_ratio_max, positive(1000)},
    {"mission_over_plan_max_s", &CriteriaSpec::mission_over_plan_max_s, between(-1e6, 1e6)},
    {"arrival_spread_max_s", &CriteriaSpec::arrival_spread_max_s, positive(1e6)},
}};

}  // namespace swarm::mission_fields
