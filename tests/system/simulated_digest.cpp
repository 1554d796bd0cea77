// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "simulated_digest.hpp"

#include <array>
#include <bit>
#include <string_view>
#include <type_traits>

#include <fmt/format.h>

#include "program.hpp"
#include "swarm_core/mission/link_faults.hpp"
#include "swarm_core/mission_file/scene_log.hpp"
#include "swarm_core/plan/plan_json.hpp"
#include "swarm_core/robot_log/robot_log_file.hpp"
#include "swarm_launcher/processes/builtin_catalogue.hpp"
#include "swarm_sim/simulation.hpp"
#include "swarmflow/core/plan_clock.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::test {
namespace {

/// FNV-1a, 64 bits. Numbers are taken by their bits: the last one counts.
class Hash {
 public:
  void add(std::string_view bytes) {
    for (const char byte : bytes) {
      value_ = (value_ ^ static_cast<unsigned char>(byte)) * 0x100'0000'01B3ULL;
    }
  }
  template <class Number>
  requires std::is_arithmetic_v<Number>
  void add(Number number) {
    const auto bytes = std::bit_cast<std::array<char, sizeof(Number)>>(number);
    add(std::string_view(bytes.data(), bytes.size()));
  }
  void add(const Vec2& v) {
    add(v.x());
    add(v.y());
  }
  void add(UtcTime t) { add(t.time_since_epoch().count()); }
  std::string hex() const { return fmt::format("{:016x}", value_); }

 private:
  std::uint64_t value_ = 0xCBF2'9CE4'8422'2325ULL;
};

/// Hashes of the robot logs, by kind of record.
struct LogHashes {
  Hash steps, estimates, notes, link;

  void operator()(const robot_log::Header& r) {
    steps.add(r.robot.value());
    steps.add(r.robots);
    steps.add(r.radius_m);
    steps.add(r.stamp);
  }
  void operator()(const robot_log::Step& r) {
    steps.add(r.stamp);
    steps.add(r.position_m);
    steps.add(r.velocity_mps);
    steps.add(r.lateness_us);
    steps.add(r.mode);
    steps.add(r.goal);
    steps.add(r.neighbours);
    steps.add(r.plan_version);
    steps.add(r.plan_time_s);
    steps.add(r.reference_x_m);
    steps.add(r.reference_y_m);
  }
  void operator()(const robot_log::Estimate& r) {
    estimates.add(r.stamp);
    estimates.add(r.neighbour.value());
    estimates.add(r.position_m);
  }
  void operator()(const robot_log::LinkStats& r) {
    link.add(r.stamp);
    link.add(r.states_sent);
    link.add(r.states_received);
    for (const std::uint32_t refused : r.refused) link.add(refused);
    for (std::size_t bin = 0; bin < Histogram::kBins; ++bin) link.add(r.state_age.bin(bin));
  }
  void operator()(const robot_log::Note& r) {
    notes.add(r.stamp);
    notes.add(r.code);
  }
};

/// Hashes what a planner and a launcher would have written.
class HashingObserver final : public launcher::SimulationObserver {
 public:
  void on_plan(std::uint32_t version, const planner::PlanResult& planned) override {
    plans.add(version);
    plans.add(to_json(planned.plan, planned.excess.by_m));
  }
  void on_clock(const PlanClock& reading) override { clock.add(plan_clock_line(reading)); }
  void on_scene(const Scene& scene, const SceneChange& change) override {
    scenes.add(scene_log_line(scene.version, change));
  }
  Hash plans, clock, scenes;
};

}  // namespace

Result<std::string> simulated_digest(const DigestCase& flight) {
  auto mission = load_mission(flight.mission_file, builtin_catalogue());
  if (!mission) return tl::unexpected(mission.error());
  // Of a very large swarm a hundred robots are enough.
  constexpr std::uint32_t kMostRobots = 200;
  if (mission->robots.count > kMostRobots) mission->robots.count = 100;
  const auto faults = parse_link_faults(flight.fault);
  if (!faults) return tl::unexpected(faults.error());

  launcher::Recording recording(*mission, launcher::Simulation::begin_utc(), 1);
  HashingObserver observer;
  launcher::SimulationOptions options;
  options.seed = flight.seed;
  options.faults = *faults;
  auto simulation = launcher::Simulation::make(*mission, options, recording, observer);
  if (!simulation) return tl::unexpected(simulation.error());
  while ((*simulation)->step()) {
  }

  // Read back from the files, because their content is what must not change.
  const TemporaryFolder folder;
  std::filesystem::create_directories(robot_log::file_of(folder.path(), RobotId(0)).parent_path());
  if (auto written = recording.write(folder.path()); !written) {
    return tl::unexpected(written.error());
  }
  LogHashes logs;
  for (std::uint32_t i = 0; i < mission->robots.count; ++i) {
    const auto read =
        robot_log::read_records(robot_log::file_of(folder.path(), RobotId(i)),
                                [&](const robot_log::Record& record) { std::visit(logs, record); });
    if (!read) return tl::unexpected(read.error());
  }
  return fmt::format("steps={} estimates={} notes={} link={} plans={} clock={} scenes={}",
                     logs.steps.hex(), logs.estimates.hex(), logs.notes.hex(), logs.link.hex(),
                     observer.plans.hex(), observer.clock.hex(), observer.scenes.hex());
}

}  // namespace swarm::test
