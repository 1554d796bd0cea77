// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/density_cap.hpp"

#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "planner_service/flow/plan_density.hpp"
#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

// Appends a line to an error of several lines.
void add_line(std::string& lines, std::string line) {
  if (!lines.empty()) lines += '\n';
  lines += std::move(line);
}

// Components that are too dense by themselves, or else where they overlap.
void describe(std::span<const Gaussian> components, std::span<const double> masses,
              std::string_view which, const DensityCap& cap, std::string& lines) {
  bool is_named = false;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const double peak_per_m2 = peak_density_per_m2(components[i], masses[i], cap.robots);
    if (peak_per_m2 <= cap.max_per_m2) continue;
    add_line(lines,
             fmt::format("{} component {} holds {:.0f} of {:.0f} robots at up to {:.3f} robots/m2, "
                         "the limit is {:.3f}: widen it {:.2f} times, take weight from it, or "
                         "raise the limit",
                         which, i, masses[i] * cap.robots, cap.robots, peak_per_m2, cap.max_per_m2,
                         std::sqrt(peak_per_m2 / cap.max_per_m2)));
    is_named = true;
  }
  const DensityPeak together = max_density(components.first(masses.size()), masses, cap.robots);
  if (is_named || together.per_m2 <= cap.max_per_m2) return;
  add_line(lines, fmt::format("{} components together reach {:.3f} robots/m2 at ({:.1f}, {:.1f}) "
                              "m, the limit is {:.3f}: move them apart, widen them, or raise the "
                              "limit",
                              which, together.per_m2, together.at_m.x(), together.at_m.y(),
                              cap.max_per_m2));
}

}  // namespace

// The mass at start and goal is fixed: no flow can keep a cap that they exceed. Both are checked,
// so that one error names all of it.
Result<void> check_components(std::span<const Gaussian> nodes, std::span<const double> supplies,
                              std::span<const double> demands, const DensityCap& cap) {
  SWARM_ASSERT(cap.max_per_m2 > 0.0 && cap.robots > 0.0);
  std::string lines;
  describe(nodes, supplies, "start", cap, lines);
  describe(nodes.subspan(supplies.size()), demands, "goal", cap, lines);
  if (lines.empty()) return {};
  return fail(ErrorCode::kInfeasible, std::move(lines));
}

}  // namespace swarm::planner
