// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace swarm {

/// The numbers that an option accepts.
struct Range {
  double low = 0.0;
  double high = 0.0;
  bool low_open = false;  ///< `low` itself is refused
  bool contains(double x) const { return (low_open ? x > low : x >= low) && x <= high; }
  bool operator==(const Range&) const = default;
};

/// Over 0 and at most `high`.
constexpr Range positive(double high) { return {.low = 0.0, .high = high, .low_open = true}; }
/// From `low` to `high`, both allowed.
constexpr Range between(double low, double high) { return {.low = low, .high = high}; }

/// `must be > 0 and <= 10`
std::string to_string(const Range& range);

/// One key that a component (a driver, a control method, a planning method) reads from its section
/// of the mission file.
struct OptionSpec {
  enum class Kind : std::uint8_t { kNumber, kCount, kChoice };
  std::string key;  ///< with its unit, e.g. "gain_hz"
  Kind kind = Kind::kNumber;
  std::string fallback;              ///< value where the file has none, as it would be written
  Range range{};                     ///< of numbers and counts
  std::vector<std::string> words{};  ///< of a choice
  std::string doc;                   ///< one line, for help and documentation
  std::string at_most{};  ///< the key of the same section that its number must not exceed, if any
  bool operator==(const OptionSpec&) const = default;
};

/// Values of a component's options by key, as they are written in a mission file. The reader of
/// the file has checked them against their specs; what is not set has its default.
class OptionValues {
 public:
  void set(std::string_view key, std::string text);
  void set(std::string_view key, double value);
  const std::string* find(std::string_view key) const;
  std::optional<double> number(std::string_view key) const;
  const std::map<std::string, std::string, std::less<>>& all() const { return values_; }
  bool operator==(const OptionValues&) const = default;

 private:
  std::map<std::string, std::string, std::less<>> values_;
};

}  // namespace swarm
