// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "planner_service/mpc/adoc.hpp"
#include "planner_service/mpc/plan_excess.hpp"
#include "planner_service/mpc/rover.hpp"
#include "planner_service/roadmap/crops_guide.hpp"
#include "planner_service/roadmap/roadmap.hpp"
#include "planner_service/roadmap/sampler.hpp"
#include "planner_service/robot_groups.hpp"
#include "planner_service/transport/density_cap.hpp"
#include "planner_service/transport/plan_density.hpp"
#include "swarm_core/base/random.hpp"
#include "swarm_core/base/time.hpp"
#include "swarm_core/gmm/mixture.hpp"
#include "swarm_core/mission/body_limits.hpp"
#include "swarm_core/mission/mission.hpp"
#include "swarm_core/plan/flow_plan.hpp"
#include "swarm_core/risk/cvar.hpp"
#include "swarm_core/world/world.hpp"

namespace swarm::planner {

enum class Method {
  kSwarmPrm,  ///< Gaussian roadmap, LP, smoothing: swarmprm.hpp
  kRover,     ///< MPC on a collocation set under the mixture's CVaR: mpc/rover.hpp
  kCrops,     ///< a guide of points that prefers open space: roadmap/crops_guide.hpp
  kAdoc,      ///< the papers' baseline, without a promise about risk: mpc/adoc.hpp
};

struct PlannerOptions {
  Method method = Method::kSwarmPrm;
  std::size_t samples = 500;          ///< n of Alg. 1
  double connection_radius_m = 20.0;  ///< r of Alg. 1, in W₂
  RiskLimit risk;
  SamplerOptions sampler;
  std::uint32_t shortcuts =
      200;                  ///< smoothing tries per route; 0 leaves the roadmap's routes alone
  double speed_mps = 1.25;  ///< of the means along a route
  DensityCap density;       ///< asked for; 0 = none
  SwarmLimits limits{};     ///< what the bodies can follow; zeros: not known, nothing is limited
  bool cap_is_automatic = false;  ///< swarmprm: no cap unless the plan is denser than `limits`
  bool density_is_timed = true;   ///< counts mass at each time; else all that ever passes
  RoverOptions rover;
  AdocOptions adoc;
  CropsOptions crops;
};

/// The options a mission asks for, with the limits of its bodies. Where the density cap is `auto`
/// SwarmPRM's speed is that of `limits` at most.
PlannerOptions planner_options(const Mission& mission);
/// The same for robots whose bodies are not known.
PlannerOptions planner_options(const PlannerSpec& spec, std::uint32_t robots);

/// What to plan; refers to the caller's objects for the duration of the call.
struct PlanRequest {
  const World& world;
  const Mixture& start;
  const Mixture& goal;
};

struct PlanStats {
  std::size_t nodes = 0;
  std::size_t edges = 0;
  double roadmap_ms = 0.0;    ///< sampling, neighbours, edge checks
  double search_ms = 0.0;     ///< shortest routes, and the proof of those taken
  double transport_ms = 0.0;  ///< LP (13)
  double smoothing_ms = 0.0;
  double total_ms = 0.0;
  double raw_mean_path_m = 0.0;      ///< Σ mass · length of the route's mean, before smoothing
  double planned_mean_path_m = 0.0;  ///< the same of the published plan
  double cost_m = 0.0;               ///< Σ mass · W₂ length of the route
  double cap_per_m2 = 0.0;           ///< that the plan keeps; 0 = none
  DensityPeak densest{};             ///< disc of 2 m, where a cap does not bound it
};

/// Something about a plan that its user should know, in one line.
struct PlanWarning {
  std::string code;
  std::string text;
};

struct PlanResult {
  FlowPlan plan;
  Roadmap roadmap;  ///< nodes: start components, goal components, samples
  PlanStats stats;
  std::vector<PlanWarning> warnings;
  PlanExcess excess{};  ///< rover: of a plan made in mid-flight, from a swarm that breaks its limit
};

/// Tells the time for PlanStats; the planner itself does not depend on it.
using StageClock = std::function<SteadyTime()>;

/// A planner that keeps what it learnt of the map from one plan to the next.
class Planner {
 public:
  explicit Planner(const PlannerOptions& options);
  ~Planner();
  Planner(Planner&&) noexcept;
  Planner& operator=(Planner&&) noexcept;

  /// The flow from start to goal by the method of the options. The same sequence of requests,
  /// options and generator states gives the same plans.
  ///
  /// kInfeasible says which component breaks the risk limit at which obstacle, or which components
  /// no route joins, and what to loosen.
  Result<PlanResult> plan(const PlanRequest& request, Rng& rng, const StageClock& clock);

  /// The measured state of a swarm as groups that a plan may start from: group_robots(), or for
  /// ROVER members of its collocation set with the most likely weights.
  Result<std::vector<RobotGroup>> measure(const World& world, const Mixture& goal,
                                          std::span<const HeardRobot> robots);

  Method method() const { return options_.method; }
  const RiskLimit& risk() const { return options_.risk; }
  /// For plans from now on.
  void set_risk(const RiskLimit& risk);

  /// Many robots are stuck about here. True when the method has another way for them: plan again.
  bool avoid(const Vec2& stuck_at_m);

 private:
  struct Memory;
  PlannerOptions options_;
  std::unique_ptr<Memory> memory_;
};

/// One plan by a planner that is made for it.
Result<PlanResult> plan(const PlanRequest& request, const PlannerOptions& options, Rng& rng,
                        const StageClock& clock);

}  // namespace swarm::planner
