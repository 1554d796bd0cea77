// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace swarm {

/// Log-linear histogram of microseconds: 16 linear bins per power of two, relative error ≤ 6.25 %,
/// from 0 to 2³² µs (71 minutes; larger values land in the last bin). Fixed memory, mergeable.
class Histogram {
 public:
  /// 16 exact bins below 16 µs, then 16 for each of the 28 octaves up to 2³² µs.
  static constexpr std::size_t kBins = 16 + (32 - 4) * 16;

  void add(std::int64_t value_us);  ///< negative values count as 0
  /// Adds all samples of another histogram.
  void merge(const Histogram& other);

  /// Adds samples known only by their bin; max_us() then is the top of that bin, at most 6.25 %
  /// high. \pre bin < kBins; asserted
  void add_bin(std::size_t bin, std::uint64_t count);

  /// Largest value that falls into a bin [µs]. \pre bin < kBins; asserted
  static std::int64_t top_us(std::size_t bin);

  /// Number of samples, of one bin or of all.
  std::uint64_t count() const { return count_; }
  std::uint64_t bin(std::size_t i) const { return bins_[i]; }

  /// The top of the first bin up to which at least q of all samples lie, and never more than
  /// max_us() [µs]; 0 if empty.
  std::int64_t quantile_us(double q) const;
  /// The largest sample [µs], exact unless it was added by its bin; 0 if empty.
  std::int64_t max_us() const { return max_us_; }

 private:
  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  std::int64_t max_us_ = 0;
};

}  // namespace swarm
