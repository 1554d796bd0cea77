// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "swarmflow/core/time.hpp"

namespace swarm::planner {

/// Whether a planner leads the robots or stands by for another one. Of several planners the one
/// that began first (the smallest epoch) leads; but a planner that was suspended for longer than
/// the takeover time, in which another one may have taken over, counts as having begun when it
/// woke. One that stands by takes over when the leading one has been silent for twice the takeover
/// time. Pure.
class RivalWatch {
 public:
  /// `takeover`: robots follow another planner after a silence of this length.
  RivalWatch(std::uint64_t epoch, Duration takeover, SteadyTime now)
      : epoch_(epoch), takeover_(takeover), stepped_at_(now) {}

  /// What has changed.
  enum class Change : std::uint8_t { kStoodBy, kTookOver };

  /// A heartbeat of another planner was received. A single one may be forged: it counts from the
  /// third within the takeover time on.
  void on_heartbeat(std::uint64_t epoch, SteadyTime now) {
    if (epoch == epoch_) return;
    if (!last_beat_at_ || epoch != rival_ || now - *last_beat_at_ > takeover_) beats_ = 0;
    rival_ = epoch;
    last_beat_at_ = now;
    ++beats_;
  }

  /// Call it at every step of the planner.
  std::optional<Change> step(SteadyTime now) {
    if (now - stepped_at_ > takeover_) woke_at_ = now;
    stepped_at_ = now;
    if (woke_at_ && now - *woke_at_ > 2 * takeover_ && beats_ < kBeatsThatCount) woke_at_.reset();
    const bool rival_lives = last_beat_at_ && now - *last_beat_at_ <= 2 * takeover_;
    if (stands_by_) {
      if (rival_lives) return std::nullopt;
      stands_by_ = false;
      woke_at_.reset();
      return Change::kTookOver;
    }
    if (!rival_lives || beats_ < kBeatsThatCount || (rival_ > epoch_ && !woke_at_))
      return std::nullopt;
    stands_by_ = true;
    return Change::kStoodBy;
  }

  bool stands_by() const { return stands_by_; }

 private:
  static constexpr int kBeatsThatCount = 3;

  std::uint64_t epoch_;
  Duration takeover_;
  SteadyTime stepped_at_;
  std::uint64_t rival_ = 0;  ///< epoch of the last other planner received
  std::optional<SteadyTime> last_beat_at_{};
  int beats_ = 0;  ///< of the rival in a row
  /// When this planner went on after a suspension, for as long as it does not know of a rival.
  std::optional<SteadyTime> woke_at_{};
  bool stands_by_ = false;
};

}  // namespace swarm::planner
