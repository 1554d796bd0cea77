// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "swarm_core/robot_log/record.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::shell {

/// The last control steps of the robots of one host, in memory that their processes share with the
/// one that started them. They survive the process that made the step, and need no disk: the
/// launcher learns where a robot is whose process was killed or frozen, and a restarted process
/// where its robot stands, also when the disk has not taken the log.
///
/// Every robot has one writer, which never waits; any number of processes may read.
class SharedSteps {
 public:
  /// Makes the memory for the robots first … first + count − 1; 264 bytes each. It exists for as
  /// long as a process has it open. Fails (kEnvironment) without such memory.
  static Result<SharedSteps> make(RobotId first, std::uint32_t count);
  /// Opens that of another process of the same user by its path(). Fails (kEnvironment) if that
  /// process is gone, (kBadInput) if the file is something else.
  static Result<SharedSteps> open(const std::string& path);
  SharedSteps(SharedSteps&& other) noexcept
      : fd_(std::exchange(other.fd_, -1)),
        slots_(std::exchange(other.slots_, nullptr)),
        first_(other.first_),
        count_(other.count_) {}
  SharedSteps& operator=(SharedSteps&& other) noexcept {
    std::swap(fd_, other.fd_);
    std::swap(slots_, other.slots_);
    std::swap(first_, other.first_);
    std::swap(count_, other.count_);
    return *this;
  }
  ~SharedSteps();

  /// `/proc/<process>/fd/<number>` of this process.
  std::string path() const;
  /// Whether it has a place for this robot. Ids below the first wrap around to large offsets.
  bool has(RobotId robot) const { return robot.value() - first_.value() < count_; }

  /// Keeps a step as the newest one of this robot. \pre has(robot), and no other thread or process
  /// records this robot's steps
  void record(RobotId robot, const robot_log::Step& step);
  /// The last two steps of a robot, the newest last; fewer if it made no more, none if what the
  /// memory contains as the newest cannot be a step. \pre has(robot)
  std::vector<robot_log::Step> last(RobotId robot) const;

 private:
  struct Slot;
  explicit SharedSteps(int fd) : fd_(fd) {}
  Result<void> map();
  Slot& slot(RobotId robot) const;

  int fd_ = -1;
  Slot* slots_ = nullptr;
  RobotId first_{};
  std::uint32_t count_ = 0;
};

}  // namespace swarm::shell
