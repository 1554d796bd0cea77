// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/drivers/simulated_robot.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

#include "robot_agent/drivers/double_integrator.hpp"
#include "robot_agent/drivers/single_integrator.hpp"
#include "robot_agent/drivers/unicycle.hpp"

namespace swarm::agent {

SimulatedRobot::SimulatedRobot(SteadyTime now, std::unique_ptr<MotionModel> model,
                               const SimulatedNoise& noise, std::uint64_t seed)
    : model_(std::move(model)), noise_(noise), at_(now), rng_(seed) {}

SimulatedRobot::SimulatedRobot(SteadyTime now, const Vec2& position_m)
    : SimulatedRobot(now, std::make_unique<SingleIntegrator>(position_m), {}, 0) {}

Vec2 SimulatedRobot::draw(double sigma_m) {
  if (sigma_m == 0.0) return Vec2::Zero();
  const double x = standard_normal(rng_);
  const double y = standard_normal(rng_);
  return sigma_m * Vec2(x, y);
}

Measurement SimulatedRobot::measure(SteadyTime now) {
  Measurement m;
  const SteadyTime until = std::min(now, valid_until_);
  if (until > at_) {
    model_->advance(to_seconds(until - at_), command_mps_);
    model_->displace(draw(noise_.motion_m));
    at_ = until;
  }
  if (now > valid_until_ && command_mps_ != Vec2::Zero()) {
    m.command_expired = true;
    m.expired_at = valid_until_;
    m.expired_position_m = model_->position_m();
    command_mps_ = Vec2::Zero();
  }
  if (now > at_) {
    model_->advance(to_seconds(now - at_), Vec2::Zero());
    at_ = now;
  }
  if (model_->has_lag()) m.velocity_mps = model_->velocity_mps();
  m.true_position_m = model_->position_m();
  m.position_m = *m.true_position_m + draw(noise_.position_m);
  return m;
}

void SimulatedRobot::command(SteadyTime now, const Vec2& velocity_mps, Duration valid_for) {
  command_mps_ = velocity_mps;
  valid_until_ = now + valid_for;
}

std::unique_ptr<Driver> make_simulated_body(const BodySpec& body, SteadyTime now,
                                            const Vec2& position_m, std::uint64_t seed) {
  Rng rng(mix_seed(seed, 1));
  std::unique_ptr<MotionModel> model;
  if (body.model == "unicycle") {
    const double heading_rad = uniform(rng, -std::numbers::pi, std::numbers::pi);
    model = std::make_unique<Unicycle>(
        position_m, heading_rad,
        UnicycleLimits{body.speed_max_mps, body.acceleration_max_mps2, body.turn_rate_max_radps});
  } else if (body.model == "double_integrator") {
    model = std::make_unique<DoubleIntegrator>(position_m, body.speed_max_mps,
                                               body.acceleration_max_mps2);
  } else {
    model = std::make_unique<SingleIntegrator>(position_m, body.speed_max_mps);
  }
  const SimulatedNoise noise{body.motion_noise_m, body.position_noise_m};
  return std::make_unique<SimulatedRobot>(now, std::move(model), noise, mix_seed(seed, 2));
}

}  // namespace swarm::agent
