// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A third-party robot program: the built-in potential field, except that robot 3 fails as its
// mission requests: two seconds after its start it throws, returns a velocity that is not a number,
// or sleeps for two seconds.
#include <chrono>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "swarmflow/mission/option_table.hpp"
#include "swarmflow/robot/run_robot.hpp"

namespace {

using namespace swarm;
using namespace swarm::agent;

struct FaultOptions {
  std::string fault = "throw";
};

const auto kOptions = OptionTable<FaultOptions>().choice(
    "fault", &FaultOptions::fault, {"throw", "nan", "sleep"}, "what robot 3 does");

class Faulty final : public ControlMethod {
 public:
  Faulty(ControlSlot inner, std::string fault)
      : inner_(std::move(inner)), fault_(std::move(fault)) {}

  void begin(const Route& route, const World& world) override { inner_->begin(route, world); }
  bool has_arrived(const ControlView& view) override { return inner_->has_arrived(view); }
  Vec2 desired_velocity(const ControlView& view, bool arrived, Rng& rng) override {
    if (++ticks_ == 20) fail();
    return ticks_ == 20 ? wrong_mps_ : inner_->desired_velocity(view, arrived, rng);
  }
  Vec2 hold(const ControlView& view) override { return inner_->hold(view); }
  std::uint32_t goal(const Vec2& position_m) const override { return inner_->goal(position_m); }
  double remaining_m() const override { return inner_->remaining_m(); }
  std::uint32_t escapes() const override { return inner_->escapes(); }

 private:
  void fail() {
    if (fault_ == "throw") throw std::runtime_error("no compass");
    if (fault_ == "nan") wrong_mps_.x() = std::numeric_limits<double>::quiet_NaN();
    if (fault_ == "sleep") std::this_thread::sleep_for(std::chrono::seconds(2));
  }

  ControlSlot inner_;
  std::string fault_;
  Vec2 wrong_mps_ = Vec2::Zero();
  int ticks_ = 0;
};

bool is_robot_3(int argc, char** argv) {
  for (int i = 1; i + 1 < argc; ++i) {
    if (std::strcmp(argv[i], "--ids") == 0 && std::strcmp(argv[i + 1], "3") == 0) return true;
  }
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  RobotRegistry registry = builtin_robots();
  const auto apf = registry.control.find("apf")->prepare;
  const bool fails = is_robot_3(argc, argv);
  registry.control.add(
      {.spec = {.name = "faulty", .doc = "Robot 3 fails", .options = kOptions.specs()},
       .prepare = [apf, fails](const ControlContext& context) -> Result<PreparedControl> {
         auto prepared = apf(context);
         if (!prepared || !fails) return prepared;
         const std::string fault = kOptions.read(context.options()).fault;
         prepared->make = [make = prepared->make, fault] {
           return ControlSlot::of(std::make_unique<Faulty>(make(), fault));
         };
         return prepared;
       }});
  return run_robot(argc, argv, registry);
}
