// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A driver of one's own: a base that reaches a commanded velocity with a first-order lag. Real
// hardware takes the place of `advance`; its driver measures where it starts and leaves
// `true_position_m` empty. What a driver has to keep is the contract in driver.hpp.
#include <algorithm>
#include <cmath>

#include <swarmflow/mission/option_table.hpp>
#include <swarmflow/robot/run_robot.hpp>

namespace {

using namespace swarm;
using namespace swarm::agent;

struct BaseOptions {
  double time_constant_s = 0.1;
};

const auto kOptions = OptionTable<BaseOptions>().number(
    "time_constant_s", &BaseOptions::time_constant_s, positive(1),
    "time in which the base makes up 63 % of a change of velocity");

class LaggingBase final : public Driver {
 public:
  LaggingBase(const DriverContext& context, const BaseOptions& options)
      : options_(options), position_m_(context.position_m), at_(context.now) {}

  Measurement measure(SteadyTime now) override {
    // The watchdog that every base has: a command is valid until valid_until_, then the base stops.
    const SteadyTime until = std::clamp(valid_until_, at_, now);
    advance(to_seconds(until - at_), command_mps_);
    advance(to_seconds(now - until), Vec2::Zero());
    at_ = now;
    Measurement measured;
    measured.position_m = position_m_;
    measured.velocity_mps = velocity_mps_;
    measured.true_position_m = position_m_;
    return measured;
  }

  void command(SteadyTime now, const Vec2& velocity_mps, Duration valid_for) override {
    command_mps_ = velocity_mps;
    valid_until_ = now + valid_for;
  }

 private:
  /// v(t) = u + (v₀ − u) e^(−t/T), integrated exactly.
  void advance(double time_s, const Vec2& wanted_mps) {
    const double decay = std::exp(-time_s / options_.time_constant_s);
    const Vec2 off_mps = velocity_mps_ - wanted_mps;
    position_m_ += time_s * wanted_mps + options_.time_constant_s * (1.0 - decay) * off_mps;
    velocity_mps_ = wanted_mps + decay * off_mps;
  }

  BaseOptions options_;
  Vec2 position_m_;
  Vec2 velocity_mps_ = Vec2::Zero();
  Vec2 command_mps_ = Vec2::Zero();
  SteadyTime at_;
  SteadyTime valid_until_;
};

BaseOptions options_of(const BodySpec& body) { return kOptions.read(body.options); }

}  // namespace

int main(int argc, char** argv) {
  RobotRegistry registry = builtin_robots();
  registry.drivers.add(
      {.spec = {.name = "lagging_base",
                .doc = "A base with a first-order lag",
                .options = kOptions.specs(),
                // After three time constants 5 % of a change are left. A mission with another
                // time constant sets robots.lag_s beside it.
                .lag = {.fixed_s = 3.0 * BaseOptions().time_constant_s}},
       .make = [](const DriverContext& context) -> Result<std::unique_ptr<Driver>> {
         return std::make_unique<LaggingBase>(context, options_of(context.body()));
       }});
  return run_robot(argc, argv, registry);
}
