// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/program/local_robot.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "robot_agent/drivers/simulated_robot.hpp"
#include "swarm_core/mission/placement.hpp"

namespace swarm::agent {
namespace {

/// Of one robot: a minute and more of a disk that takes nothing. Reserved, and not used until then.
constexpr std::size_t kWaitingBytes = 128U << 10U;

/// The last step of the robot's process before; empty if there was none, or nothing recorded it.
/// The disk may lack the end of a log, and a process that was started by hand shares no steps.
std::optional<robot_log::Step> last_step(const LocalRobotsSpec& spec, RobotId robot) {
  std::optional<robot_log::Step> last;
  const auto take = [&last](const std::vector<robot_log::Step>& steps) {
    if (!steps.empty() && (!last || steps.back().stamp > last->stamp)) last = steps.back();
  };
  if (spec.steps != nullptr) take(spec.steps->last(robot));
  if (const auto logged = robot_log::last_steps(robot_log::file_of(spec.run_dir, robot))) {
    take(*logged);
  }
  return last;
}

/// A respawned robot starts where its body came to rest after its last step, a new one, and one
/// whose last step is not known, from the position that the mission places it at.
Vec2 first_position(const LocalRobotsSpec& spec, RobotId robot, const Vec2& placed_m,
                    Duration period) {
  const auto last = last_step(spec, robot);
  return last ? robot_log::rest_position_m(*last, period) : placed_m;
}

/// Robots fill their chunks at different steps, so that a process does not write all its logs at
/// the same tick.
LogFile open_log(const Mission& mission, const LocalRobotsSpec& spec, RobotId robot) {
  const robot_log::Header header{.robot = robot,
                                 .robots = mission.robots.count,
                                 .process_id = static_cast<std::uint32_t>(::getpid()),
                                 .radius_m = body_of(mission.robots, robot).radius_m,
                                 .stamp = spec.utc_now};
  const bool many = spec.count >= robot_log::kManyRobots;
  const std::uint32_t at_once = many ? robot_log::kRecordsOfManyAtOnce : robot_log::kRecordsAtOnce;
  auto stream =
      spec.files.append_to(robot_log::format_of(robot_log::file_of(spec.run_dir, robot), header),
                           many ? shell::Flush::kLazily : shell::Flush::kAtOnce, kWaitingBytes);
  return LogFile(robot_log::Writer::to(std::make_unique<QueuedChunks>(std::move(stream)), header,
                                       at_once, robot.value() % at_once),
                 robot, spec.steps);
}

/// A driver that does not start is shut down again, as it may hold a device.
Result<std::unique_ptr<Driver>> start_driver(const DriverRegistry& drivers,
                                             const DriverContext& context) {
  const std::string& name = context.body().model;
  const DriverEntry* entry = drivers.find(name);
  if (entry == nullptr) {
    return fail(ErrorCode::kBadInput,
                fmt::format("robots.model is {}, which this program does not have", name));
  }
  const auto refuse = [&](const Error& error) {
    return fail(error.code,
                fmt::format("robot {}: driver {}: {}", context.robot.value(), name, error.message));
  };
  auto driver = entry->make(context);
  if (!driver) return refuse(driver.error());
  if (const auto started = (*driver)->start(); !started) {
    (*driver)->shutdown();
    return refuse(started.error());
  }
  return driver;
}

}  // namespace

Result<LocalRobots> make_local_robots(const Mission& mission, const World& world,
                                      const RobotRegistry& registry, const LocalRobotsSpec& spec) {
  const auto places = place_robots(mission, spec.seed);
  if (!places) return tl::unexpected(places.error());
  LocalRobots made;
  made.robots.reserve(spec.count);
  const auto options_of = AgentOptionsOf::make(mission, registry.control);
  if (!options_of) return tl::unexpected(options_of.error());
  made.read_density = options_of->reads_density();
  for (std::uint32_t i = 0; i < spec.count; ++i) {
    const RobotId id(spec.first.value() + i);
    const Vec2& placed_m = (*places)[id.value()];
    const Vec2 position_m =
        first_position(spec, id, placed_m, from_seconds(1.0 / mission.control.rate_hz));
    AgentIdentity self = agent_identity(mission, id);
    // A position other than the placed one means that the robot has driven before.
    self.underway = position_m != placed_m;
    made.any_is_underway = made.any_is_underway || self.underway;
    auto driver = start_driver(registry.drivers, {.mission = mission,
                                                  .robot = id,
                                                  .position_m = position_m,
                                                  .now = spec.now,
                                                  .seed = body_seed(id, spec.seed)});
    if (!driver) return tl::unexpected(driver.error());
    made.robots.push_back({.loop = RobotLoop(world, (*options_of)(id), self),
                           .driver = *std::move(driver),
                           .rng = agent_rng(id, spec.seed),
                           .log = open_log(mission, spec, id)});
  }
  return made;
}

}  // namespace swarm::agent
