// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "robot_agent/agent.hpp"
#include "robot_agent/drivers/driver.hpp"
#include "robot_agent/inbox.hpp"
#include "swarm_core/blackbox/blackbox_file.hpp"
#include "swarm_link/messages.hpp"

namespace swarm::agent {

/// One robot of a process: its agent, its body, its black box, and what it says of itself.
class Robot {
 public:
  Robot(const World& world, Shared<AgentOptions> options, const AgentIdentity& self, Rng rng,
        std::unique_ptr<Driver> driver, blackbox::Writer box);

  struct Tick {
    SteadyTime now;
    UtcTime utc_now;
    Duration lateness{};
    Duration period{};
    std::optional<PlanTime> plan_time{};              ///< of the plan's clock, if it is known
    const PlannedDensity* planned_density = nullptr;  ///< then, if it is asked for
  };

  /// Measures, decides, commands and records one step. Adds how old the states were that it used.
  void step(const Tick& tick, const Inbox& inbox, const NewPlan* new_plan, Histogram& state_age);

  /// The state to tell the neighbours, if this step asked for it.
  const std::optional<link::RobotStateMessage>& to_say() const { return to_say_; }

  /// Health for the status topic.
  link::RobotStatusMessage status() const;

  bool mode_changed() const { return mode_changed_; }
  RobotMode mode() const { return output_.mode; }
  RobotId id() const { return id_; }
  const Vec2& position_m() const { return position_m_; }
  const EchoGuard& echo() const { return echo_; }

  void note(UtcTime utc_now, const std::string& code, const std::string& text,
            std::int64_t caused_utc_ns = 0);
  void record(const blackbox::Record& record) { box_.append(record); }
  std::uint64_t records_dropped() const { return box_.dropped(); }

 private:
  RobotId id_;
  Agent agent_;
  std::unique_ptr<Driver> driver_;
  blackbox::Writer box_;
  EchoGuard echo_;
  AgentOutput output_;
  Vec2 position_m_ = Vec2::Zero();
  bool mode_changed_ = false;
  bool stepped_ = false;
  std::uint32_t sequence_ = 0;
  std::uint32_t said_ = 0;
  std::uint32_t heard_ = 0;
  std::uint32_t ticks_ = 0;
  std::uint32_t late_ticks_ = 0;
  std::optional<link::RobotStateMessage> to_say_;
  Rng rng_;
};

}  // namespace swarm::agent
