// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/papers/flown.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <mutex>
#include <optional>
#include <thread>

#include "robot_agent/methods/apf/cotangent_repulsion.hpp"
#include "robot_agent/methods/diffusion/intermittent_diffusion_keys.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_monitor/audit/audit.hpp"
#include "swarm_monitor/report/report.hpp"

namespace swarm::launcher {
namespace {

// Distances to obstacles are evaluated at every n-th recorded point.
constexpr std::size_t kRiskEvery = 5;
// Rate of recorded points; robots are assumed to move straight between them. Small robots are
// controlled a thousand times a second, and all their points would not fit into memory. A robot of
// 1 cm drives 1.5 mm between two points.
constexpr double kPoints_hz = 200.0;

/// Control periods from one recorded point to the next.
std::uint64_t periods_a_point(const Mission& mission) {
  return static_cast<std::uint64_t>(std::max(1.0, mission.control.rate_hz / kPoints_hz));
}

/// Keeps what the simulation publishes for the audit: plans, clock readings and scenes.
class PlanKept final : public SimulationObserver {
 public:
  void on_plan(std::uint32_t version, const planner::PlanResult& planned) override {
    plans.push_back({version, planned.plan});
  }
  void on_clock(const PlanClock& reading) override { clock.push_back(reading); }
  void on_scene(const Scene& scene, const SceneChange&) override { scenes.push_back(scene); }
  std::vector<monitor::PublishedPlan> plans;
  std::vector<PlanClock> clock;
  std::vector<Scene> scenes;
};

/// Copies what the audit measured; values it could not measure stay NaN.
void take_tracking(const monitor::Tracking& tracking, Flown& flown) {
  if (tracking.w2) {
    flown.w2_m = tracking.w2->w2_m;
    flown.w2_floor_m = tracking.w2->floor_m;
  }
  flown.centre_lag_s = tracking.centre_lag_s.value_or(Flown::kUnknown);
  if (tracking.own.lag) flown.lag_p90_s = tracking.own.lag->p90_s;
  if (tracking.density) {
    flown.density_per_m2 = tracking.density->worst_per_m2;
    flown.density_p95_per_m2 = tracking.density->p95_per_m2;
    flown.planned_density_per_m2 = tracking.density->planned_worst_per_m2;
  }
  flown.over_plan_s = tracking.mission_over_plan_s.value_or(Flown::kUnknown);
}

/// Share of the recorded points of moving robots nearer to an obstacle than the plan allows.
double risk_share(const monitor::RecordedRun& run) {
  const double near_m = -run.mission.planner.risk_delta_m;
  std::size_t looked = 0;
  std::size_t inside = 0;
  for (const monitor::Track& track : run.tracks) {
    for (std::size_t k = 0; k < track.points.size(); k += kRiskEvery) {
      if (track.points[k].mode != RobotMode::kMoving) continue;
      ++looked;
      if (run.mission.world.distance_m(track.points[k].position_m) < near_m) ++inside;
    }
  }
  return looked == 0 ? 0.0 : static_cast<double>(inside) / static_cast<double>(looked);
}

/// E = max (F + G) over the robots at each time, from their recorded positions, as in the official
/// code of the diffusion paper. All robots are recorded at the same times, evenly from the first
/// step on.
std::vector<double> energy_m2(const monitor::RecordedRun& run) {
  const ControlSpec& control = run.mission.control;
  const auto keys = agent::intermittent_diffusion_keys().read(control.options);
  const double range_m = keys.range_or_default_m(run.mission.robots.radius_m);
  const agent::CotangentOptions repulsion{keys.strength_m2, range_m};
  const double points_hz = control.rate_hz / static_cast<double>(periods_a_point(run.mission));
  const auto every = static_cast<std::size_t>(std::max(1.0, Flown::kEnergyEvery_s * points_hz));
  std::vector<double> energy;
  std::vector<agent::Neighbour> others;
  std::size_t steps = std::numeric_limits<std::size_t>::max();
  for (const monitor::Track& track : run.tracks) steps = std::min(steps, track.points.size());
  for (std::size_t k = 0; k < steps; k += every) {
    double most = 0.0;
    for (const monitor::Track& self : run.tracks) {
      const Vec2& at_m = self.points[k].position_m;
      others.clear();
      for (const monitor::Track& other : run.tracks) {
        const Vec2& p = other.points[k].position_m;
        if (&other == &self || (p - at_m).squaredNorm() >= range_m * range_m) continue;
        others.push_back({.robot = other.robot, .position_m = p});
      }
      most = std::max(most, run.mission.goal_shape->at(at_m).energy_m2 +
                                agent::cotangent_repulsion(at_m, others, repulsion).energy_m2);
    }
    energy.push_back(most);
  }
  return energy;
}

}  // namespace

/// Simulates the mission in lock-step, then audits the recording as that of a real run.
Result<Flown> fly(const Mission& mission, const SimulationOptions& options, bool draw) {
  const auto begin = std::chrono::steady_clock::now();
  Recording recording(mission, Simulation::begin_utc(), periods_a_point(mission));
  PlanKept plan;
  plan.scenes.push_back(first_scene(mission.world.obstacles().size()));
  auto simulation = Simulation::make(mission, options, recording, plan);
  if (!simulation) return tl::unexpected(simulation.error());
  while ((*simulation)->step()) {
    if (shell::stop_requests() > 0) (*simulation)->interrupt();
  }
  Flown flown{.seed = options.seed,
              .outcome = (*simulation)->outcome(),
              .wall_s = to_seconds(std::chrono::steady_clock::now() - begin)};
  const Simulation::Cost cost = (*simulation)->cost();
  // The audit knows plans, scenes, clock and tracks alone, nothing of the simulation.
  const monitor::AuditedRun audited = monitor::audit_recorded({.mission = mission,
                                                               .plans = plan.plans,
                                                               .begin = Simulation::begin_utc(),
                                                               .tracks = recording.tracks(),
                                                               .scenes = plan.scenes,
                                                               .clock = plan.clock});
  const monitor::Audit& audit = audited.audit;
  flown.robots = audit.robots;
  flown.arrived = audit.arrived;
  flown.contacts = audit.collisions_robot + audit.collisions_obstacle;
  flown.plan_ms = cost.plan_ms;
  flown.ns_per_agent_step = cost.median_step_ns;
  flown.mission_s = audit.mission_s.value_or(0.0);
  flown.path_m = audit.mean_path_m.value_or(0.0);
  flown.bound_m = audit.geodesic_bound_m.value_or(0.0);
  flown.robot_gap_m = audit.min_robot_gap_m.value_or(0.0);
  flown.obstacle_gap_m = audit.min_obstacle_gap_m.value_or(0.0);
  for (const double gap_m : audited.obstacles.by_robot_m) {
    flown.clearance_m += gap_m / static_cast<double>(audited.obstacles.by_robot_m.size());
  }
  flown.risk_share = risk_share(audited.run);
  take_tracking(audit.tracking, flown);
  if (mission.control.shape_tolerance_m2) flown.energy_m2 = energy_m2(audited.run);
  if (!draw) return flown;
  flown.paths_svg = monitor::paths_svg(audited);
  flown.robot_gaps_m = audited.robots.by_robot_m;
  flown.obstacle_gaps_m = audited.obstacles.by_robot_m;
  return flown;
}

/// Threads take the next flight from a common counter. Consecutive flights are of different
/// missions, so that other load on the machine affects the wall times of all missions alike.
Result<std::vector<std::vector<Flown>>> fly_in_turns(
    std::span<const Mission> missions, std::uint32_t seeds, const SimulationOptions& options,
    const std::function<void(const Flown&)>& done) {
  std::mutex output_mutex;
  std::vector<std::optional<Result<Flown>>> results(missions.size() * seeds);
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < results.size() && shell::stop_requests() == 0; i = next++) {
      SimulationOptions own = options;
      own.seed = i / missions.size() + 1;
      // Seeds begin at 1; the flight of seed 1 is drawn.
      results[i] = fly(missions[i % missions.size()], own, own.seed == 1);
      const std::lock_guard lock(output_mutex);
      if (*results[i]) done(**results[i]);
    }
  };
  {
    // This thread works as well, hence one thread less than cores; jthread joins at the end of the
    // block.
    std::vector<std::jthread> others;
    for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) others.emplace_back(work);
    work();
  }
  std::vector<std::vector<Flown>> flown(missions.size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (!results[i]) return fail(ErrorCode::kEnvironment, "interrupted");
    if (!*results[i]) return tl::unexpected(results[i]->error());
    flown[i % missions.size()].push_back(**std::move(results[i]));
  }
  return flown;
}

}  // namespace swarm::launcher
