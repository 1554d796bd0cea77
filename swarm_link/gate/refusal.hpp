// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <tl/expected.hpp>

/// Reasons for which a received message is refused, and their counters.
namespace swarm::link {

/// The order is part of the wire format: StatusMessage::refused is indexed by it.
enum class RefusalReason : std::uint8_t {
  kUndecodable,  ///< bytes that are not a sample
  kSchema,       ///< unknown schema version
  kOversized,    ///< more elements than the contract allows
  kNotFinite,    ///< NaN or infinity
  kOutOfRange,   ///< id, enum, position or speed beyond its limits
  kBadGaussian,  ///< covariance not symmetric positive definite
  kBadMass,      ///< weights negative, over 1, not summing to 1, or not conserved
  kStale,        ///< older epoch, version, sequence number or stamp than the newest accepted
  kDuplicate,    ///< the same as the newest accepted
  kClockSkew,    ///< stamp further from our clock than timing.clock_skew_refuse_s
  kForged,       ///< sent under our id, or a time, version or number that cannot be reached yet
  kCount
};

inline constexpr std::size_t kRefusalReasons = static_cast<std::size_t>(RefusalReason::kCount);

/// Kebab-case, e.g. "not-finite".
std::string_view to_string(RefusalReason reason);

/// Result of a check: the value, or why the message is refused.
template <class T>
using Checked = tl::expected<T, RefusalReason>;

inline tl::unexpected<RefusalReason> refuse(RefusalReason reason) {
  return tl::unexpected<RefusalReason>(reason);
}

/// Refusals so far, by reason. Not thread-safe.
class RefusalCounters {
 public:
  void count(RefusalReason reason, std::uint32_t times = 1) {
    counts_[static_cast<std::size_t>(reason)] += times;
  }
  std::uint32_t operator[](RefusalReason reason) const {
    return counts_[static_cast<std::size_t>(reason)];
  }
  const std::array<std::uint32_t, kRefusalReasons>& all() const { return counts_; }
  std::uint64_t total() const;
  bool operator==(const RefusalCounters&) const = default;

 private:
  std::array<std::uint32_t, kRefusalReasons> counts_{};
};

/// Calls `report(reason, times)` for every reason that was counted since the last call with the
/// same `reported`, which remembers what was reported.
template <class Report>
void report_new(const RefusalCounters& refused, RefusalCounters& reported, Report report) {
  for (std::size_t i = 0; i < kRefusalReasons; ++i) {
    const auto reason = static_cast<RefusalReason>(i);
    const std::uint32_t times = refused[reason] - reported[reason];
    if (times == 0) continue;
    reported.count(reason, times);
    report(reason, times);
  }
}

}  // namespace swarm::link
