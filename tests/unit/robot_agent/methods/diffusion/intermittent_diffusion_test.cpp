// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/methods/diffusion/intermittent_diffusion.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "robot_agent/agent.hpp"
#include "robot_agent/methods/builtin_methods.hpp"
#include "robot_agent/methods/diffusion/intermittent_diffusion_keys.hpp"
#include "swarm_core/mission/placement.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::agent {
namespace {

IntermittentDiffusionKeys keys_of(const Mission& mission) {
  return intermittent_diffusion_keys().read(mission.control.options);
}

Mission letter_q() {
  return *load_mission(std::filesystem::path(SWARM_SOURCE_DIR) /
                       "deploy/missions/diffusion_q.yaml");
}

/// A whole swarm in lock step: all receive all within R, as of the same moment.
class Swarm {
 public:
  Swarm(const Mission& mission, std::uint64_t seed, bool filtered = true)
      : mission_(mission), filtered_(filtered), positions_m_(*place_robots(mission, seed)) {
    velocities_mps_.assign(positions_m_.size(), Vec2::Zero());
    for (std::uint32_t i = 0; i < mission_.robots.count; ++i) {
      const Shared<AgentOptions> options = agent_options(mission_, RobotId(i));
      methods_.emplace_back(
          intermittent_diffusion_options(mission_, body_of(mission_.robots, RobotId(i))));
      methods_.back().begin(Route{}, mission_.world);
      filters_.emplace_back(mission_.world, options->safety);
      rngs_.emplace_back(agent_rng(RobotId(i), seed));
    }
  }

  void step() {
    const auto desired = [&](std::size_t i) {
      receive(i);
      const ControlView view{now_, positions_m_[i], received_, mission_.world};
      const Vec2 desired_mps = methods_[i].desired_velocity(view, false, rngs_[i]);
      return filtered_ ? filters_[i].filter(positions_m_[i], desired_mps, received_) : desired_mps;
    };
    std::vector<Vec2> next_mps;
    for (std::size_t i = 0; i < methods_.size(); ++i) next_mps.push_back(desired(i));
    const Duration period = from_seconds(1.0 / mission_.control.rate_hz);
    before_m_ = positions_m_;
    for (std::size_t i = 0; i < methods_.size(); ++i) {
      positions_m_[i] += to_seconds(period) * next_mps[i];
    }
    velocities_mps_ = next_mps;
    now_ += period;
  }

  /// E = max(F + G) before the last step [m²].
  double error_m2() const {
    double most = 0.0;
    for (const auto& m : methods_) most = std::max(most, m.energy_m2());
    return most;
  }

  double nearest_pair_m() const {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < positions_m_.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        nearest_m = std::min(nearest_m, (positions_m_[i] - positions_m_[j]).norm());
      }
    }
    return nearest_m;
  }

  /// V = ΣF + ½ΣG [m²].
  double total_m2() {
    const CotangentOptions repulsion{keys_of(mission_).strength_m2, range_m()};
    double sum = 0.0;
    for (std::size_t i = 0; i < positions_m_.size(); ++i) {
      receive(i);
      sum += mission_.goal_shape->at(positions_m_[i]).energy_m2 +
             0.5 * cotangent_repulsion(positions_m_[i], received_, repulsion).energy_m2;
    }
    return sum;
  }

  /// What the corner of g at R may have added to V in the last step: for every pair that came into
  /// range or left it, |g| of the smooth cotangent there.
  double crossings_m2() const {
    const auto squared = [](const std::vector<Vec2>& at, std::size_t i, std::size_t j) {
      return (at[i] - at[j]).squaredNorm();
    };
    const double range_squared = range_m() * range_m();
    double sum = 0.0;
    for (std::size_t i = 0; i < positions_m_.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const double now = squared(positions_m_, i, j);
        if ((now < range_squared) == (squared(before_m_, i, j) < range_squared)) continue;
        sum += std::abs(keys_of(mission_).strength_m2 /
                        std::tan(0.5 * std::numbers::pi * now / range_squared));
      }
    }
    return sum;
  }

  std::uint32_t diffusions() const {
    std::uint32_t sum = 0;
    for (const auto& m : methods_) sum += m.escapes();
    return sum;
  }

 private:
  double range_m() const { return 10.0 * mission_.robots.radius_m; }

  void receive(std::size_t i) {
    received_.clear();
    for (std::size_t j = 0; j < positions_m_.size(); ++j) {
      if (j == i || (positions_m_[j] - positions_m_[i]).norm() >= range_m()) continue;
      received_.push_back({RobotId(static_cast<std::uint32_t>(j)), positions_m_[j],
                           velocities_mps_[j], mission_.robots.radius_m});
    }
  }

  Mission mission_;
  bool filtered_;
  std::vector<Vec2> positions_m_;
  std::vector<Vec2> before_m_;
  std::vector<Vec2> velocities_mps_;
  std::vector<IntermittentDiffusion> methods_;
  std::vector<SafetyFilter> filters_;
  std::vector<Rng> rngs_;
  std::vector<Neighbour> received_;
  SteadyTime now_{std::chrono::seconds(1000)};
};

TEST(IntermittentDiffusion, FormsALetterWhereGradientDescentStalls) {
  const Mission mission = letter_q();
  Mission plain = mission;
  plain.control.options.set("diffusion_time_s", 0.0);
  constexpr std::uint64_t kSeed = 1;
  constexpr int kSteps = 6000;
  Swarm swarm(mission, kSeed);
  Swarm descent(plain, kSeed);

  double error_m2 = std::numeric_limits<double>::infinity();
  double nearest_m = error_m2;
  for (int i = 0; i < kSteps && error_m2 > keys_of(mission).tolerance_m2; ++i) {
    swarm.step();
    error_m2 = swarm.error_m2();
    nearest_m = std::min(nearest_m, swarm.nearest_pair_m());
  }
  double least_m2 = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kSteps; ++i) {
    descent.step();
    least_m2 = std::min(least_m2, descent.error_m2());
  }

  EXPECT_LE(error_m2, keys_of(mission).tolerance_m2);
  EXPECT_GE(nearest_m, 2.0 * mission.robots.radius_m);
  EXPECT_GT(swarm.diffusions(), 0U);
  EXPECT_GT(least_m2, keys_of(mission).tolerance_m2);
  EXPECT_EQ(descent.diffusions(), 0U);
}

TEST(IntermittentDiffusion, AgentsWithDeadReckonedNeighboursComeToRest) {
  const Mission mission = letter_q();
  const auto& goals = mission.goal.components();
  std::vector<PlanNode> nodes{{mission.start.components()[0].gaussian, MissionTime(0), 1.0}};
  std::vector<PlanLeg> legs;
  for (std::uint32_t i = 0; i < goals.size(); ++i) {
    nodes.push_back({goals[i].gaussian, MissionTime(10), goals[i].weight});
    legs.push_back({0, i + 1, goals[i].weight});
  }
  const FlowPlan plan = *FlowPlan::make(nodes, legs);
  std::vector<Vec2> positions_m = *place_robots(mission, 1);
  const auto robots = static_cast<std::uint32_t>(positions_m.size());
  std::vector<Agent> agents;
  std::vector<Rng> rngs;
  for (std::uint32_t i = 0; i < robots; ++i) {
    agents.emplace_back(mission.world, agent_options(mission, RobotId(i)),
                        agent_identity(mission, RobotId(i)));
    rngs.push_back(agent_rng(RobotId(i), 1));
    agents.back().accept_plan(plan, positions_m[i]);
  }
  std::vector<AgentOutput> outputs(robots);
  for (AgentOutput& output : outputs) output.send = true;
  SteadyTime now{std::chrono::seconds(1000)};
  const Duration period = from_seconds(1.0 / mission.control.rate_hz);

  std::size_t settled = 0;
  for (std::uint32_t step = 1; step < 6000 && settled < robots; ++step, now += period) {
    for (std::uint32_t j = 0; j < robots; ++j) {
      if (!outputs[j].send) continue;
      for (std::uint32_t i = 0; i < robots; ++i) {
        if (i == j) continue;
        agents[i].receive({RobotId(j), step, now, positions_m[j], outputs[j].velocity_mps},
                          positions_m[i]);
      }
    }
    settled = 0;
    for (std::uint32_t i = 0; i < robots; ++i) {
      outputs[i] = agents[i].tick({now, positions_m[i], MissionPhase::kRunning, true}, rngs[i]);
      settled += outputs[i].settled ? 1 : 0;
    }
    for (std::uint32_t i = 0; i < robots; ++i) {
      positions_m[i] += to_seconds(period) * outputs[i].velocity_mps;
    }
  }

  EXPECT_EQ(settled, robots);
}

TEST(IntermittentDiffusion, StepsKeepTheBoundAndLoseEnergy) {
  Mission mission = letter_q();
  mission.control.options.set("diffusion_time_s", 0.0);
  mission.control.options.set("diffusion_gain_hz", 1000.0);  // the bound alone limits the step
  mission.control.cruise_mps = mission.robots.speed_max_mps = 100.0;
  Swarm swarm(mission, 3, false);  // and no filter turns it

  double before_m2 = swarm.total_m2();
  const double at_first_m2 = before_m2;
  for (int i = 0; i < 400; ++i) {
    swarm.step();
    const double after_m2 = swarm.total_m2();
    EXPECT_LE(after_m2, before_m2 + swarm.crossings_m2() + 1e-12) << i;
    before_m2 = after_m2;
  }

  EXPECT_LT(before_m2, 0.1 * at_first_m2);
}

TEST(IntermittentDiffusion, ArrivesWithHysteresis) {
  const Mission mission = letter_q();
  IntermittentDiffusion method(intermittent_diffusion_options(mission, mission.robots));
  method.begin(Route{}, mission.world);
  const Vec2 on_letter_m(3.6, 0.35);
  // Alone, F + G is the squared distance to the stroke's edge, 0.25 m from its middle.
  SteadyTime now;
  const auto arrived_off_by = [&](double squared_m2) {
    now += std::chrono::milliseconds(10);
    const Vec2 p = on_letter_m + Vec2(0.25 + std::sqrt(squared_m2), 0.0);
    return method.has_arrived({now, p, {}, mission.world});
  };

  EXPECT_FALSE(arrived_off_by(0.06));
  EXPECT_TRUE(arrived_off_by(0.02));
  EXPECT_FALSE(arrived_off_by(0.08));
}

TEST(IntermittentDiffusion, GoalIsTheComponentOfTheLargestDensity) {
  const auto g = [](Vec2 mean, double sigma) {
    return Gaussian::from_parameters(mean, sigma, sigma, 0);
  };
  const FlowPlan plan = *FlowPlan::make({{g({0, 0}, 1), MissionTime(0), 1.0},
                                         {g({10, 0}, 1), MissionTime(5), 0.5},
                                         {g({20, 0}, 3), MissionTime(9), 0.5}},
                                        {{0, 1, 0.5}, {0, 2, 0.5}});
  IntermittentDiffusion method(IntermittentDiffusionOptions{});

  method.set_goals(plan);
  method.begin(Route{}, World{});

  EXPECT_EQ(method.goal({10.5, 0}), 0U);
  EXPECT_EQ(method.goal({18, 0}), 1U);
  EXPECT_EQ(method.goal({14, 0}), 1U);  // 4 σ from the one, 2 σ from the other
}

}  // namespace
}  // namespace swarm::agent
