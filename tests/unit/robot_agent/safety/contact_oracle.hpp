// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::agent {

/// The bodies and the protocol that the oracle assumes.
struct OracleOptions {
  std::size_t robots = 0;
  double radius_m = 0.0;
  double speed_mps = 0.0;
  Duration expected_silence{};  ///< σ: a healthy robot may be silent for this long
  Duration stands_after{};      ///< a silent robot has stopped this long after its last state
};

/// Decides whether a contact in a scene with silent robots counts: whether a robot with bounded
/// speed could have avoided it for certain. It knows what each robot could know: which states have
/// reached it, and which were lost. It uses nothing of the code under test.
///
/// Robot a is, towards b,
///
///   receiving   no state of b was lost since its last one
///   unaware     one was lost, but the last one is not older than σ: b may as well be healthy
///   outside     σ is over, and a can outrun b: when it could first know of the last robot that
///               fell silent, a run in some direction kept it out of all discs that silent robots
///               can have reached at bounded speed until they stand
///   within      σ is over, and no such run exists: whatever a does, a silent robot may be there
///   unable      its process does not run, and its last command has run out: its body stands
///
/// The contact of two robots that follow the protocol does not count only where one was unaware and
/// the other unaware, within or unable: no control of either is safe then, as the one cannot know
/// that it matters, and the other neither where the first is nor where it drives. All others count.
/// One that is receiving or outside has a control that avoids the contact; two that are within or
/// unable avoid it where both stand. Walls and robots that are received do not excuse a contact.
/// One with an adversarial robot, which avoids nothing, counts where its victim was receiving or
/// outside.
class ContactOracle {
 public:
  explicit ContactOracle(const OracleOptions& options)
      : options_(options), known_(options.robots * options.robots), robots_(options.robots) {}

  enum class Awareness { kReceiving, kUnaware, kOutside, kWithin, kUnable };

  /// A state of `sender` that does not reach `receiver`.
  void on_lost(std::size_t receiver, std::size_t sender) { of(receiver, sender).has_lost = true; }
  /// A state of `sender` that `receiver` reads at a tick.
  void on_received(std::size_t receiver, std::size_t sender, SteadyTime as_of,
                   const Vec2& position_m) {
    of(receiver, sender) = {.as_of = as_of, .position_m = position_m};
  }
  /// A tick of a robot at this position, after what it has read. O(robots), and O(robots · runs
  /// tried) when one falls silent.
  void on_tick(std::size_t robot, SteadyTime now, const Vec2& position_m);
  void set_unable(std::size_t robot, bool is_unable) { robots_[robot].is_unable = is_unable; }
  void set_adversarial(std::size_t robot) { robots_[robot].is_adversarial = true; }

  Awareness awareness(std::size_t robot, std::size_t other) const;
  /// Whether a contact of the two now counts.
  bool counts(std::size_t a, std::size_t b) const;

 private:
  /// What one robot knows of another.
  struct Known {
    SteadyTime as_of{};
    Vec2 position_m = Vec2::Zero();
    bool has_lost = false;
    bool is_silent = false;
    bool is_within = false;
  };
  struct Robot {
    bool is_unable = false;
    bool is_adversarial = false;
  };
  Known& of(std::size_t robot, std::size_t other) {
    return known_[robot * options_.robots + other];
  }
  bool can_outrun(std::size_t robot, SteadyTime now, const Vec2& position_m);

  OracleOptions options_;
  std::vector<Known> known_;
  std::vector<Robot> robots_;
};

}  // namespace swarm::agent
