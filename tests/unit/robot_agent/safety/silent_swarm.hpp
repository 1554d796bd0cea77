// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "robot_agent/loop/motion_permit.hpp"
#include "robot_agent/neighbours/neighbour_table.hpp"
#include "robot_agent/neighbours/silent_robots.hpp"
#include "robot_agent/neighbours/whereabouts.hpp"
#include "robot_agent/safety/safety_filter.hpp"
#include "robot_agent/send_policy.hpp"
#include "swarm_link/channels/launcher_beat.hpp"
#include "swarmflow/core/box.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/scene.hpp"
#include "tests/unit/robot_agent/safety/contact_oracle.hpp"

/// Robots with the parts that keep them apart, a bus between them and a launcher, all of which may
/// fail: for tests of what robots do about silence. Time is a number of milliseconds.
namespace swarm::agent {

/// From `begin_ms` to `end_ms`; empty by default.
struct FaultSpan {
  int begin_ms = 0;
  int end_ms = 0;
  bool covers(int ms) const { return begin_ms <= ms && ms < end_ms; }
};

/// What happens to one robot, and what it wants.
struct RobotPart {
  Vec2 start_m = Vec2::Zero();
  Vec2 goal_m = Vec2::Zero();
  int phase_ms = 0;     ///< of its ticks, a multiple of 10
  FaultSpan frozen{};   ///< its process does not run; its sockets keep what arrives
  FaultSpan cut_off{};  ///< nothing reaches it, nothing of it reaches others
  FaultSpan mute{};     ///< nothing of it reaches others, launcher included; it receives
  std::optional<std::uint32_t> rams{};  ///< drives into this robot and avoids none
};

/// How silent robots are treated.
enum class SilenceRule { kKeep, kForget };

/// Which states a process receives, and what of a robot that it received and that left its cells.
enum class Cells {
  kOne,              ///< all
  kLeftIsElsewhere,  ///< those of the cells around it, as by groups; it takes the robot for
                     ///< elsewhere
  kLeftIsSilent,     ///< the same; it takes the robot for silent
  kNoLateRobots      ///< as kLeftIsElsewhere, and beats list no late robots
};

class SilentSwarm {
 public:
  static constexpr double kRadius_m = 0.2;
  static constexpr double kSpeed_mps = 1.5;
  static constexpr double kCommunicationRadius_m = 6.0;

  SilentSwarm(const Box& bounds_m, const std::vector<RobotPart>& parts, SilenceRule rule,
              Cells cells = Cells::kOne);
  ~SilentSwarm();

  /// Two robots, and when they were nearest.
  struct Approach {
    double gap_m = std::numeric_limits<double>::infinity();  ///< between their surfaces
    std::size_t first = 0;
    std::size_t second = 0;
    int at_ms = 0;
    bool counts = false;  ///< a contact, and one that counts (ContactOracle)
  };
  /// The nearest approach of two robots up to this time, in continuous time: between two changes of
  /// a velocity all robots move straight. Ends with the first contact.
  Approach fly_until(int end_ms);

 private:
  struct Robot;
  SteadyTime time() const;
  void tick(Robot& robot);
  void receive(Robot& robot);
  Vec2 desired_mps(const Robot& robot) const;
  void publish(Robot& robot, const Vec2& velocity_mps);
  bool is_lost(const Robot& sender) const;
  void launch();
  Circle fallen(const Robot& robot) const;
  void move(Approach& nearest);

  Box bounds_m_;
  SilenceRule rule_;
  Cells cells_;
  int now_ms_ = 0;
  std::vector<std::unique_ptr<Robot>> robots_;
  link::LauncherBeat beat_;
  Scene scene_;
  ContactOracle oracle_;
};

}  // namespace swarm::agent
