// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A monitor of one's own: once per second of mission time it prints how far the swarm's centre is
// from where the plan has it, and every event when it is received. It observes a run in flight, or
// with --recorded a finished one.
#include <cstdio>
#include <string_view>
#include <vector>

#include <swarmflow/observe/observer.hpp>

namespace {

using namespace swarm;
using namespace swarm::monitor;

class CentreWatch final : public Observer {
 public:
  void on_mission(const Mission& mission) override {
    positions_m_.assign(mission.robots.count, Vec2::Zero());
    arrived_.assign(mission.robots.count, false);
    std::printf("%s: %u robots\n", mission.name.c_str(), mission.robots.count);
  }

  void on_plan(const ObservedPlan& plan) override {
    flow_ = plan.flow;
    std::printf("plan %u: %.0f s, %zu nodes\n", plan.version, flow_.duration().count(),
                flow_.nodes().size());
  }

  void on_state(const ObservedState& state) override {
    ++states_;
    positions_m_[state.robot.value()] = state.position_m;
    arrived_[state.robot.value()] = state.mode == RobotMode::kArrived;
  }

  // Reliable, as state updates are not: none that reports an arrival is lost.
  void on_status(const ObservedStatus& status) override {
    arrived_[status.robot.value()] = status.arrived;
  }

  void on_clock(const ObservedClock& clock) override {
    if (flow_.empty() || clock.phase != MissionPhase::kRunning) return;
    if (clock.mission_time_s < reported_s_ + 1.0) return;
    reported_s_ = clock.mission_time_s;
    Vec2 planned_m = Vec2::Zero();
    const Mixture planned = flow_.mixture_at(MissionTime(clock.plan_time_s));
    for (const WeightedGaussian& c : planned.components()) {
      planned_m += c.weight * c.gaussian.mean_m();
    }
    Vec2 centre_m = Vec2::Zero();
    for (const Vec2& position_m : positions_m_) {
      centre_m += position_m / static_cast<double>(positions_m_.size());
    }
    std::printf("%5.0f s: centre (%.1f, %.1f) m, %.2f m off the plan, %zu arrived\n",
                clock.mission_time_s, centre_m.x(), centre_m.y(), (centre_m - planned_m).norm(),
                arrived());
    std::fflush(stdout);
  }

  void on_event(const ObservedEvent& event) override {
    std::printf("%s from %s: %s\n", event.severity.c_str(), event.source.c_str(),
                event.text.c_str());
  }

  std::size_t arrived() const {
    std::size_t count = 0;
    for (const bool arrived : arrived_) count += arrived ? 1 : 0;
    return count;
  }
  bool all_arrived() const { return !arrived_.empty() && arrived() == arrived_.size(); }
  std::size_t states() const { return states_; }

 private:
  FlowPlan flow_;
  std::vector<Vec2> positions_m_;
  std::vector<bool> arrived_;
  double reported_s_ = 0.0;
  std::size_t states_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: own_monitor RUN_DIR [--recorded]\n");
    return 2;
  }
  CentreWatch watch;
  const bool recorded = argc > 2 && std::string_view(argv[2]) == "--recorded";
  int polls_left = 50 * 300;  // about five minutes
  const auto observed =
      recorded
          ? observe_recording(argv[1], watch)
          : observe_run(argv[1], watch, [&] { return !watch.all_arrived() && --polls_left > 0; });
  if (!observed) {
    std::fprintf(stderr, "own_monitor: %s\n", observed.error().message.c_str());
    return 1;
  }
  std::printf("%zu states, %zu robots arrived\n", watch.states(), watch.arrived());
  return watch.all_arrived() ? 0 : 1;
}
