// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <variant>

#include "robot_agent/drivers/double_integrator.hpp"
#include "robot_agent/drivers/single_integrator.hpp"
#include "robot_agent/drivers/unicycle.hpp"
#include "swarmflow/core/random.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/robot/driver.hpp"

namespace swarm::agent {

/// Noise of motion and measurement, zero-mean, Gaussian and independent per axis.
struct SimulatedNoise {
  double motion_m = 0.0;    ///< σ of w(k), once a control step while a command is in force
  double position_m = 0.0;  ///< σ of the measured position
};

/// A simulated body, which moves on with the time passed to measure():
///
///   x(k+1) = f(x(k), u(k)) + w(k)  [ROVER, eq. 9],  y(k) = x(k) + n(k)
///
/// f is a motion model, a step k ends with each measurement. When its command runs out it is
/// commanded to stop, which one with inertia does as fast as it can. Deterministic in its seed.
class SimulatedRobot final : public Driver {
 public:
  using Model = std::variant<SingleIntegrator, DoubleIntegrator, Unicycle>;

  SimulatedRobot(SteadyTime now, const Model& model, const SimulatedNoise& noise,
                 std::uint64_t seed);
  /// A single integrator that knows where it is.
  SimulatedRobot(SteadyTime now, const Vec2& position_m);

  Measurement measure(SteadyTime now) override;
  void command(SteadyTime now, const Vec2& velocity_mps, Duration valid_for) override;

 private:
  MotionModel& model();
  Vec2 draw(double sigma_m);

  Model model_;
  SimulatedNoise noise_;
  Vec2 command_mps_ = Vec2::Zero();
  SteadyTime at_;
  SteadyTime valid_until_;
  std::unique_ptr<Rng> rng_;  // none without noise: it is large
};

/// The seed of a robot's simulated body: the same in a process and in a lock-step simulation, and
/// different from the seed of its agent.
constexpr std::uint64_t body_seed(RobotId robot, std::uint64_t run_seed) {
  constexpr std::uint64_t kBodySeed = 0xB0D7;
  return mix_seed(mix_seed(run_seed, robot.value()), kBodySeed);
}

/// The body that a mission specifies, at rest; a unicycle has a random heading.
SimulatedRobot make_simulated_body(const BodySpec& body, SteadyTime now, const Vec2& position_m,
                                   std::uint64_t seed);

}  // namespace swarm::agent
