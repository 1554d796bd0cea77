// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "swarmflow/core/time.hpp"

namespace swarm::planner {

/// Whether a planner leads the robots or stands by for another one. A planner that has just joined
/// receives for one takeover time before it leads. Of several that lead, the one that began first
/// (the smallest epoch) stays; one that was suspended for longer than the takeover time, in which
/// another one may have taken over, counts as having begun when it woke. A planner that stands by
/// takes over when the leading one has been silent for twice the takeover time. Pure.
class RivalWatch {
 public:
  /// `takeover`: robots follow another planner after a silence of this length.
  RivalWatch(std::uint64_t epoch, Duration takeover, SteadyTime now)
      : epoch_(epoch), takeover_(takeover), since_(now), stepped_at_(now) {}

  enum class Role : std::uint8_t { kJoining, kLeading, kStandingBy };

  /// This planner has made a new plan, under another epoch.
  void begin_epoch(std::uint64_t epoch) { epoch_ = epoch; }

  /// A heartbeat of any planner was received.
  void on_heartbeat(std::uint64_t epoch, SteadyTime now) {
    if (epoch == epoch_) return;
    if (!last_beat_at_ || epoch != rival_ || now - *last_beat_at_ > takeover_) beats_ = 0;
    rival_ = epoch;
    last_beat_at_ = now;
    ++beats_;
  }

  /// The new role, when it has changed. Call it at every step of the planner.
  std::optional<Role> step(SteadyTime now) {
    if (now - stepped_at_ > takeover_) woke_at_ = now;
    stepped_at_ = now;
    const Role next = next_role(now);
    if (next == role_) return std::nullopt;
    role_ = next;
    since_ = now;
    if (role_ == Role::kLeading) woke_at_.reset();
    return role_;
  }

  Role role() const { return role_; }

 private:
  /// A heartbeat or two may be forged.
  static constexpr int kBeatsThatCount = 3;

  Role next_role(SteadyTime now) {
    const bool rival_lives = last_beat_at_ && now - *last_beat_at_ <= 2 * takeover_;
    const bool rival_counts = rival_lives && beats_ >= kBeatsThatCount;
    if (role_ == Role::kStandingBy) return rival_lives ? role_ : Role::kLeading;
    if (role_ == Role::kJoining) {
      if (rival_counts) return Role::kStandingBy;
      return rival_lives || now - since_ <= takeover_ ? role_ : Role::kLeading;
    }
    if (woke_at_ && now - *woke_at_ > 2 * takeover_ && !rival_counts) woke_at_.reset();
    return rival_counts && (rival_ < epoch_ || woke_at_) ? Role::kStandingBy : role_;
  }

  std::uint64_t epoch_;
  Duration takeover_;
  Role role_ = Role::kJoining;
  SteadyTime since_;  ///< when it took its role
  SteadyTime stepped_at_;
  std::uint64_t rival_ = 0;  ///< epoch of the last other planner received
  std::optional<SteadyTime> last_beat_at_{};
  int beats_ = 0;  ///< of the rival in a row
  /// When this planner went on after a suspension, for as long as it does not know of a rival.
  std::optional<SteadyTime> woke_at_{};
};

}  // namespace swarm::planner
