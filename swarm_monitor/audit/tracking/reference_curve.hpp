// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarmflow/core/linalg.hpp"

namespace swarm::monitor {

/// The planned position of one robot over plan time, x_ref(τ), built from what that robot logged:
/// linear between its entries, and beyond the first and the last one continued at the speed there
/// for kBeyond_s, since a plan in force for a few seconds shows only a few seconds of its curve.
class ReferenceCurve {
 public:
  static constexpr double kSpacing_s = 0.2;  ///< entries nearer than this are left out
  static constexpr double kBeyond_s = 10.0;
  static constexpr double kWindow_s = 60.0;  ///< lags are looked for up to here
  /// A robot this near to a waiting reference is in time: neighbours push each other this far [m].
  static constexpr double kAtRest_m = 1.0;
  static constexpr double kRest_mps = 0.1;  ///< a slower reference waits

  /// Entries that do not ascend in τ are left out.
  void add(double plan_time_s, const Vec2& reference_m);
  bool empty() const { return entries_.empty(); }

  /// x_ref(τ). O(log entries). \pre not empty
  Vec2 at(double plan_time_s) const;

  /// Signed lag of a position at τ [s]: τ − τ', where τ' is the time within the window at which the
  /// reference passes nearest to the position. Of several such times the one nearest to τ counts,
  /// so that a waiting reference is an interval with lag 0 inside it. Late is positive. A robot
  /// within kAtRest_m of a reference that waits at τ is in time: the time that the reference has
  /// waited does not measure how long the robot still needs. O(entries in the window). \pre not
  /// empty
  double lag_s(const Vec2& position_m, double plan_time_s) const;

 private:
  struct Entry {
    double plan_time_s = 0.0;
    Vec2 at_m = Vec2::Zero();
  };
  /// The straight pieces: piece k ends at entry k; the first and the last lie beyond the entries.
  std::size_t pieces() const { return entries_.size() + 1; }
  std::pair<Entry, Entry> piece(std::size_t k) const;
  bool waits_at(double plan_time_s) const;

  std::vector<Entry> entries_;
};

}  // namespace swarm::monitor
