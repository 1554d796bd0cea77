// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A control method of one's own: each robot follows a carrot on its path through the plan and keeps
// a small distance from its neighbours. The safety filter, which limits the velocity desired by any
// method, prevents contacts.
#include <algorithm>

#include <swarmflow/mission/option_table.hpp>
#include <swarmflow/robot/run_robot.hpp>

namespace {

using namespace swarm;
using namespace swarm::agent;

struct CarrotOptions {
  double carrot_m = 2.0;
  double gain_hz = 0.8;
  double gap_m = 0.8;
  double speed_mps = 1.0;  // not a key: of the mission and the body
  double radius_m = 0.2;   // not a key: of the body
};

const auto kOptions =
    OptionTable<CarrotOptions>()
        .number("carrot_m", &CarrotOptions::carrot_m, positive(100), "how far ahead the carrot is")
        .number("gain_hz", &CarrotOptions::gain_hz, positive(10), "speed per metre to the carrot")
        .number("gap_m", &CarrotOptions::gap_m, between(0, 10), "gap below which neighbours push");

class Carrot final : public ControlMethod {
 public:
  explicit Carrot(const CarrotOptions& options) : options_(options) {}

  void begin(const Route& route, const World&) override {
    route_ = route;
    progress_m_ = 0.0;
  }

  bool has_arrived(const ControlView& view) override {
    const bool is_near = (end_m() - view.position_m).norm() < (arrived_ ? 2.0 : 0.6);
    return arrived_ = is_near && route_.goal.contains_99(view.position_m);
  }

  Vec2 desired_velocity(const ControlView& view, bool arrived, Rng&) override {
    // The nearest point of the path ahead, in steps of a quarter of a metre.
    for (double s_m = progress_m_; s_m <= progress_m_ + options_.carrot_m; s_m += 0.25) {
      if (distance_m(view, s_m) < distance_m(view, progress_m_)) progress_m_ = s_m;
    }
    const Vec2 carrot_m = arrived ? end_m() : route_.path.at(progress_m_ + options_.carrot_m);
    Vec2 velocity_mps = options_.gain_hz * (carrot_m - view.position_m);
    const double speed_mps = velocity_mps.norm();
    if (speed_mps > options_.speed_mps) velocity_mps *= options_.speed_mps / speed_mps;
    return velocity_mps + hold(view);
  }

  Vec2 hold(const ControlView& view) override {
    Vec2 push_mps = Vec2::Zero();
    for (const Neighbour& neighbour : view.close) {
      const Vec2 away_m = view.position_m - neighbour.position_m;
      const double gap_m = away_m.norm() - neighbour.radius_m - options_.radius_m;
      if (gap_m >= options_.gap_m) continue;
      push_mps += 0.5 * (1.0 - std::max(gap_m, 0.0) / options_.gap_m) * away_m.normalized();
    }
    return push_mps;
  }

  std::uint32_t goal(const Vec2&) const override { return route_.sink; }
  double remaining_m() const override { return route_.path.length_m() - progress_m_; }
  std::uint32_t escapes() const override { return 0; }

 private:
  Vec2 end_m() const { return route_.path.vertices_m().back(); }
  double distance_m(const ControlView& view, double s_m) const {
    return (route_.path.at(s_m) - view.position_m).norm();
  }

  CarrotOptions options_;
  Route route_;
  double progress_m_ = 0.0;
  bool arrived_ = false;
};

/// Called once for each kind of body in the mission.
Result<PreparedControl> prepare(const ControlContext& context) {
  CarrotOptions options = kOptions.read(context.options());
  options.speed_mps = std::min(context.mission.control.cruise_mps, context.body.speed_max_mps);
  options.radius_m = context.body.radius_m;
  return PreparedControl{.make = [options] { return ControlSlot::of<Carrot>(options); }};
}

}  // namespace

int main(int argc, char** argv) {
  RobotRegistry registry = builtin_robots();
  registry.control.add({.spec = {.name = "carrot",
                                 .doc = "Runs after a carrot on its path through the plan",
                                 .options = kOptions.specs()},
                        .prepare = prepare});
  return run_robot(argc, argv, registry);
}
