// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/metrics/histogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "swarm_core/base/assert.hpp"

namespace swarm {
namespace {

/// Bins per power of two, and its logarithm: every value below 2⁴ has a bin of its own.
constexpr std::size_t kPerOctave = 16;
constexpr int kLinearBits = 4;
constexpr std::int64_t kLargest_us = (std::int64_t{1} << 32) - 1;

/// The leading one of a value selects the octave and the 4 bits after it the bin, as in a
/// floating-point number with a 4-bit mantissa.
std::size_t bin_of(std::int64_t value_us) {
  const auto value = static_cast<std::uint64_t>(std::clamp<std::int64_t>(value_us, 0, kLargest_us));
  if (value < kPerOctave) return static_cast<std::size_t>(value);
  const int octave = static_cast<int>(std::bit_width(value)) - 1 - kLinearBits;
  return kPerOctave * static_cast<std::size_t>(octave) + static_cast<std::size_t>(value >> octave);
}

}  // namespace

/// The inverse of bin_of(): the largest value that it maps to `bin`.
std::int64_t Histogram::top_us(std::size_t bin) {
  SWARM_ASSERT(bin < kBins);
  if (bin < kPerOctave) return static_cast<std::int64_t>(bin);
  const std::size_t octave = bin / kPerOctave - 1;
  const auto mantissa = static_cast<std::int64_t>(kPerOctave + bin % kPerOctave);
  return ((mantissa + 1) << octave) - 1;
}

void Histogram::add(std::int64_t value_us) {
  ++bins_[bin_of(value_us)];
  ++count_;
  max_us_ = std::max(max_us_, value_us);
}

void Histogram::merge(const Histogram& other) {
  for (std::size_t i = 0; i < kBins; ++i) bins_[i] += other.bins_[i];
  count_ += other.count_;
  max_us_ = std::max(max_us_, other.max_us_);
}

void Histogram::add_bin(std::size_t bin, std::uint64_t count) {
  if (count == 0) return;
  max_us_ = std::max(max_us_, top_us(bin));
  bins_[bin] += count;
  count_ += count;
}

/// Reports the top of a bin and never the middle, so a quantile is not understated. The exact
/// maximum limits it, or the last bin would overstate it.
std::int64_t Histogram::quantile_us(double q) const {
  if (count_ == 0) return 0;
  const double wanted = std::clamp(q, 0.0, 1.0) * static_cast<double>(count_);
  std::uint64_t so_far = 0;
  for (std::size_t i = 0; i < kBins; ++i) {
    so_far += bins_[i];
    if (bins_[i] > 0 && static_cast<double>(so_far) >= wanted) return std::min(top_us(i), max_us_);
  }
  return max_us_;
}

}  // namespace swarm
