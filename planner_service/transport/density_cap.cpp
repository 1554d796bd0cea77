// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/transport/density_cap.hpp"

#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

void describe(std::span<const Gaussian> components, std::span<const double> masses,
              std::string_view which, const DensityCap& cap, std::string& lines) {
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const double peak_per_m2 = peak_density_per_m2(components[i], masses[i], cap.robots);
    if (peak_per_m2 <= cap.max_per_m2) continue;
    lines += fmt::format(
        "{}{} component {} holds {:.0f} of {:.0f} robots at up to {:.3f} robots/m2, the limit is "
        "{:.3f}: widen it {:.2f} times, take weight from it, or raise the limit",
        lines.empty() ? "" : "\n", which, i, masses[i] * cap.robots, cap.robots, peak_per_m2,
        cap.max_per_m2, std::sqrt(peak_per_m2 / cap.max_per_m2));
  }
}

}  // namespace

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
