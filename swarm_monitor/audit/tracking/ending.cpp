// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/ending.hpp"

#include <algorithm>

namespace swarm::monitor {
namespace {

/// A fixed seed, so that the same run gives the same numbers, and four samples of the goal per
/// distance to reduce the scatter of the floor.
constexpr std::uint64_t kEndingSeed = 7;
constexpr std::size_t kDraws = 4;

/// The last step at which the robot followed a plan in time; null if it never did.
const TrackPoint* last_reference(const Track& track) {
  const auto it = std::find_if(track.points.rbegin(), track.points.rend(),
                               [](const TrackPoint& point) { return point.plan_version > 0; });
  return it == track.points.rend() ? nullptr : &*it;
}

/// Every n-th point, at most `most`: an assignment is O(n³).
std::vector<Vec2> thinned(const std::vector<Vec2>& points, std::size_t most) {
  if (points.size() <= most) return points;
  const std::size_t every = (points.size() + most - 1) / most;
  std::vector<Vec2> kept;
  for (std::size_t i = 0; i < points.size(); i += every) kept.push_back(points[i]);
  return kept;
}

}  // namespace

/// Robots that were lost are left out: they did not end anywhere on purpose, and the audit reports
/// them elsewhere.
Ending ending_of(const RecordedRun& run, std::size_t most_robots) {
  Ending ending;
  std::vector<Vec2> positions, references;
  std::size_t robots = 0, near = 0, wide = 0;
  for (const Track& track : run.tracks) {
    if (!track.ended_gracefully || track.points.empty()) continue;
    ++robots;
    const Vec2& at = track.points.back().position_m;
    positions.push_back(at);
    const TrackPoint* const last = last_reference(track);
    if (last == nullptr) continue;
    references.push_back(last->reference_m());
    // Distance of the end to the slot that the robot's own last reference gave it.
    const double off_m = (at - references.back()).norm();
    near += off_m <= Ending::kNear_m ? 1 : 0;
    wide += off_m <= Ending::kWide_m ? 1 : 0;
  }
  if (robots == 0) return ending;
  if (!references.empty()) {
    ending.own_place_share = static_cast<double>(near) / static_cast<double>(robots);
    ending.own_place_wide_share = static_cast<double>(wide) / static_cast<double>(robots);
  }
  Rng rng(kEndingSeed);
  ending.to_goal = distance_to(run.goal(), thinned(positions, most_robots), kDraws, rng);
  if (references.size() == robots) {
    ending.references_to_goal =
        distance_to(run.goal(), thinned(references, most_robots), kDraws, rng);
  }
  return ending;
}

}  // namespace swarm::monitor
