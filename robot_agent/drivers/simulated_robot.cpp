// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/drivers/simulated_robot.hpp"

#include <algorithm>
#include <numbers>

namespace swarm::agent {
namespace {

/// The motion model by its name in the mission; any other name is a single integrator. The heading
/// of a unicycle is drawn.
SimulatedRobot::Model model_of(const BodySpec& body, const Vec2& position_m, std::uint64_t seed) {
  if (body.model == "unicycle") {
    Rng rng(seed);
    return Unicycle(position_m, uniform(rng, -std::numbers::pi, std::numbers::pi),
                    {body.speed_max_mps, body.acceleration_max_mps2, body.turn_rate_max_radps});
  }
  if (body.model == "double_integrator") {
    return DoubleIntegrator(position_m, body.speed_max_mps, body.acceleration_max_mps2);
  }
  return SingleIntegrator(position_m, body.speed_max_mps);
}

}  // namespace

SimulatedRobot::SimulatedRobot(SteadyTime now, const Model& model, const SimulatedNoise& noise,
                               std::uint64_t seed)
    : model_(model), noise_(noise), at_(now) {
  if (noise_.motion_m > 0.0 || noise_.position_m > 0.0) rng_ = std::make_unique<Rng>(seed);
}

SimulatedRobot::SimulatedRobot(SteadyTime now, const Vec2& position_m)
    : SimulatedRobot(now, SingleIntegrator(position_m), {}, 0) {}

MotionModel& SimulatedRobot::model() {
  return std::visit([](MotionModel& any) -> MotionModel& { return any; }, model_);
}

/// x is drawn before y in statements of their own: the order of evaluation within an expression is
/// unspecified, and runs are to be reproducible.
[[gnu::hot]] Vec2 SimulatedRobot::draw(double sigma_m) {
  if (sigma_m == 0.0) return Vec2::Zero();
  const double x = standard_normal(*rng_);
  const double y = standard_normal(*rng_);
  return sigma_m * Vec2(x, y);
}

/// Moves the body on to `now` in two parts, since its command may have run out in between: the
/// watchdog stops it then, as in a real driver.
[[gnu::hot]] Measurement SimulatedRobot::measure(SteadyTime now) {
  MotionModel& body = model();
  Measurement m;
  const SteadyTime until = std::min(now, valid_until_);
  if (until > at_) {
    body.advance(to_seconds(until - at_), command_mps_);
    body.displace(draw(noise_.motion_m));
    at_ = until;
  }
  if (now > valid_until_ && command_mps_ != Vec2::Zero()) {
    m.command_expired = true;
    m.expired_at = valid_until_;
    m.expired_position_m = body.position_m();
    command_mps_ = Vec2::Zero();
  }
  if (now > at_) {
    body.advance(to_seconds(now - at_), Vec2::Zero());
    at_ = now;
  }
  if (body.has_lag()) m.velocity_mps = body.velocity_mps();
  m.true_position_m = body.position_m();
  m.position_m = *m.true_position_m + draw(noise_.position_m);
  return m;
}

[[gnu::hot]] void SimulatedRobot::command(SteadyTime now, const Vec2& velocity_mps,
                                          Duration valid_for) {
  command_mps_ = velocity_mps;
  valid_until_ = now + valid_for;
}

/// Model and noise draw from seeds of their own.
SimulatedRobot make_simulated_body(const BodySpec& body, SteadyTime now, const Vec2& position_m,
                                   std::uint64_t seed) {
  const SimulatedNoise noise{body.motion_noise_m, body.position_noise_m};
  return SimulatedRobot(now, model_of(body, position_m, mix_seed(seed, 1)), noise,
                        mix_seed(seed, 2));
}

}  // namespace swarm::agent
