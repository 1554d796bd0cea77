// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/tighten.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "planner_service/roadmap/connect.hpp"
#include "planner_service/roadmap/squeeze.hpp"
#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {
namespace {

// A move must save this much: rounding alone is no progress.
constexpr double kWorthwhile_m = 1e-6;
// A route longer than this many spacings is sampled with a wider spacing, which bounds the time for
// any mission.
constexpr double kMostParts = 2000.0;
constexpr std::array kTightenSteps{1.0, 0.5};

// Inserts waypoints on the geodesics so that no leg is longer than the spacing in W₂.
Waypoints resampled(const Waypoints& waypoints, double spacing_m) {
  spacing_m = std::max(spacing_m, w2_length_m(waypoints) / kMostParts);
  Waypoints fine{waypoints.front()};
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    const double length_m = wasserstein2(waypoints[i - 1], waypoints[i]);
    const auto parts = static_cast<int>(std::ceil(length_m / spacing_m));
    const Geodesic geodesic(waypoints[i - 1], waypoints[i]);
    for (int part = 1; part < parts; ++part) {
      fine.push_back(geodesic.at(static_cast<double>(part) / parts));
    }
    fine.push_back(waypoints[i]);
  }
  return fine;
}

}  // namespace

// Gauss-Seidel relaxation of the route length: each move is pushed and squeezed back into free
// space.
void tighten(Waypoints& waypoints, const World& world, const RiskLimit& risk,
             const TightenOptions& options, EdgeChecker& checker) {
  if (waypoints.size() < 3) return;
  const double k = cvar_coefficient(risk.alpha);
  // Slightly more than σ_min needs, so that the squeeze that follows does not end below it.
  const double room_m = k * options.sigma_min_m * (1.0 + 1e-6) - risk.delta_m;
  Waypoints fine = resampled(waypoints, options.spacing_m);
  for (std::uint32_t sweep = 0; sweep < options.sweeps; ++sweep) {
    // Odd waypoints, then even ones (red-black order): the neighbours of a waypoint that moves are
    // fixed.
    for (const std::size_t first : {std::size_t{1}, std::size_t{2}}) {
      for (std::size_t i = first; i + 1 < fine.size(); i += 2) {
        const Gaussian& before = fine[i - 1];
        const Gaussian& after = fine[i + 1];
        const Gaussian middle = Geodesic(before, after).at(0.5);
        const Geodesic move(fine[i], middle);
        const double now_m = wasserstein2(before, fine[i]) + wasserstein2(fine[i], after);
        // A whole step may cost more in shape than it saves in path; half of it often does not.
        for (const double step : kTightenSteps) {
          const std::optional<Gaussian> moved = squeeze_into_free(
              push_out(move.at(step), world, room_m), world, k, risk.delta_m, options.sigma_min_m);
          if (!moved) continue;
          const double then_m = wasserstein2(before, *moved) + wasserstein2(*moved, after);
          if (now_m - then_m < kWorthwhile_m) continue;
          if (!checker.is_free(before, *moved, kPlanTolerance_m) ||
              !checker.is_free(*moved, after, kPlanTolerance_m)) {
            continue;
          }
          fine[i] = *moved;
          break;
        }
      }
    }
  }
  waypoints = std::move(fine);
}

}  // namespace swarm::planner
