// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace swarm {

/// Log-linear histogram of microseconds: 16 linear bins per power of two, relative error ≤ 6.25 %,
/// from 1 µs to 2³² µs (71 minutes; larger values land in the last bin). Fixed memory, mergeable.
class Histogram {
 public:
  static constexpr std::size_t kBins = 16 + (32 - 4) * 16;

  void add(std::int64_t value_us);  ///< negative values count as 0
  void merge(const Histogram& other);
  void add_bin(std::size_t bin, std::uint64_t count);

  std::uint64_t count() const { return count_; }
  std::uint64_t bin(std::size_t i) const { return bins_[i]; }

  /// Smallest value v such that at least q of all samples are ≤ the top of v's bin [µs]; 0 if empty.
  std::int64_t quantile_us(double q) const;
  std::int64_t max_us() const { return max_us_; }

 private:
  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  std::int64_t max_us_ = 0;
};

}  // namespace swarm
