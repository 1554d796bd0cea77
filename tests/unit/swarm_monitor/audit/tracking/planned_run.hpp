// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "swarm_monitor/audit/recorded_run.hpp"

namespace swarm::monitor {

/// A swarm that flies a plan in a field of 130 × 60 m, made by formula, with the plan's clock:
///
///        y 60 ┌──────────────────────────────────┐
///             │  A₀ ──────▶ A₁ ───wait───▶ ... A │   two streams of Gaussians, σ 3 m, that start
///             at │        ▒▒ obstacle               │   x = 15, wait from τ = 30 to 40 s at x
///             = 52.5 │  B₀ ──────▶ B₁ ───wait───▶ ... B │   and end at x = 90 at τ = 70 s; 1.25
///             m/s
///           0 └──────────────────────────────────┘
///
/// The clock starts at 2 s and runs at half speed from 22 to 32 s, so that τ = 70 s is at 77 s.
struct PlannedRun {
  static constexpr double kStart_s = 2.0, kDuration_s = 70.0, kStep_s = 0.25;

  std::uint32_t robots = 60;
  double sigma_m = 3.0;
  double cap_per_m2 = 0.48;  ///< what the plan has in its densest disc of 2 m, for σ = 3 m
  /// Where robot i is, given the plan time; the default is on its reference.
  std::function<Vec2(std::uint32_t, double)> position_m{};
  /// What robot i logs as plan time and reference, if it logs any.
  bool logs_references = true;
  std::function<double(double)> logged_plan_time_s{};               ///< default: τ
  std::function<Vec2(std::uint32_t, double)> logged_reference_m{};  ///< default: the plan's
  /// The log of this robot ends here, without an exit.
  std::optional<std::uint32_t> falls{};
  double falls_at_s = 25.0;
  double end_s = 90.0;

  /// The reference of robot i at τ.
  Vec2 reference_m(std::uint32_t robot, double plan_time_s) const;
  FlowPlan plan() const;
  /// The run. Criteria are set so that the unchanged swarm meets all of them.
  RecordedRun make() const;

  /// τ at a time.
  static double plan_time_s(double time_s);
};

}  // namespace swarm::monitor
