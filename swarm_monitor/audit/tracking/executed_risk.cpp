// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/executed_risk.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "swarm_core/base/assert.hpp"
#include "swarm_core/mission/scene_bodies.hpp"
#include "swarm_core/risk/mixture_cvar.hpp"
#include "swarm_monitor/audit/tracking/swarm_walk.hpp"

namespace swarm::monitor {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Risk [m] below which the comparison with the plan is skipped: beyond 5 m from an obstacle the
/// exact distance does not matter.
constexpr double kNear_m = -5.0;

/// The map of a run over time, rebuilt only when it changed. Bodies of dead robots are left out: as
/// obstacles they would count robots twice.
class WorldOverTime {
 public:
  explicit WorldOverTime(const RecordedRun& run) : run_(run), world_(&run.mission.world) {}

  // The newest scene made by `time_s`; while its obstacles move, the map is rebuilt for every call.
  // O(scenes).
  const World& at(double time_s) {
    const UtcTime now = run_.begin + from_seconds(time_s);
    const Scene* newest = nullptr;
    for (const Scene& scene : run_.scenes) {
      const UtcTime made{Duration(static_cast<std::int64_t>(scene.version))};
      if (scene.version == 0 || made <= now) newest = &scene;
    }
    const bool as_before = newest == scene_ && !moved_;
    if (newest == nullptr || as_before) return *world_;
    scene_ = newest;
    moved_ = newest->moves(now);
    changed_ = world_at(run_.mission.world, without_bodies(*newest), now);
    world_ = &changed_;
    return *world_;
  }

 private:
  const RecordedRun& run_;
  const World* world_;
  const Scene* scene_ = nullptr;
  bool moved_ = false;
  World changed_;
};

}  // namespace

/// nth_element separates the ⌊αn⌋ largest values from the next one, which enters with the fraction
/// that is left: no sort, O(n).
double empirical_cvar(std::span<double> values, double alpha) {
  SWARM_ASSERT(!values.empty() && alpha > 0.0 && alpha < 1.0);
  const double tail = alpha * static_cast<double>(values.size());
  if (tail <= 1.0) return *std::max_element(values.begin(), values.end());
  const auto whole = static_cast<std::size_t>(tail);  // < values.size()
  const auto next = values.begin() + static_cast<std::ptrdiff_t>(whole);
  std::nth_element(values.begin(), next, values.end(), std::greater<>());
  double sum = (tail - static_cast<double>(whole)) * *next;
  for (auto it = values.begin(); it != next; ++it) sum += *it;
  return sum / tail;
}

/// At each moment, for each obstacle: the empirical CVaR of −sd over the robots against the CVaR of
/// the planned mixture. Risk is in metres; a value ≤ δ keeps the mission's bound.
std::optional<ExecutedRisk> executed_risk(const RecordedRun& run,
                                          std::span<const PlanMoment> moments) {
  const PlannerSpec& planner = run.mission.planner;
  const RobotsSpec& robots = run.mission.robots;
  ExecutedRisk risk{.worst_m = -kInfinity,
                    .planned_worst_m = -kInfinity,
                    .filter_m = -(robots.radius_m + run.mission.safety.obstacle_margin_m)};
  std::size_t kept = 0;
  std::vector<double> negated_m;
  SwarmWalk walk(run.tracks);
  WorldOverTime worlds(run);
  for (const PlanMoment& moment : moments) {
    const std::vector<RobotNow>& living = walk.at(moment.time_s);
    const World& world = worlds.at(moment.time_s);
    if (living.empty() || world.convex_obstacles().empty()) continue;
    const Mixture mixture = moment.mixture();
    RiskMoment now{.time_s = moment.time_s, .executed_m = -kInfinity, .planned_m = -kInfinity};
    // Per obstacle, since the plan's constraint holds for each obstacle separately; the moment is
    // judged by the worst one.
    for (const ConvexObstacle& obstacle : world.convex_obstacles()) {
      negated_m.clear();
      for (const RobotNow& robot : living) {
        negated_m.push_back(-obstacle.signed_distance(robot.position_m).distance_m);
      }
      const double executed_m = empirical_cvar(negated_m, planner.risk_alpha);
      const double planned_m =
          mixture_tail_risk(negated_distance(mixture, obstacle), planner.risk_alpha).cvar_m;
      now.executed_m = std::max(now.executed_m, executed_m);
      now.planned_m = std::max(now.planned_m, planned_m);
      if (std::max(executed_m, planned_m) <= kNear_m) continue;
      risk.most_over_plan_m =
          std::max(risk.most_over_plan_m.value_or(-kInfinity), executed_m - planned_m);
    }
    risk.worst_m = std::max(risk.worst_m, now.executed_m);
    risk.planned_worst_m = std::max(risk.planned_worst_m, now.planned_m);
    if (now.executed_m <= planner.risk_delta_m) ++kept;
    risk.moments.push_back(now);
  }
  if (risk.moments.empty()) return std::nullopt;
  risk.kept_share = static_cast<double>(kept) / static_cast<double>(risk.moments.size());
  return risk;
}

}  // namespace swarm::monitor
