// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace swarm {

/// The numbers that an option accepts: [low, high], or (low, high] with low_open.
struct Range {
  double low = 0.0;       ///< least number accepted
  double high = 0.0;      ///< largest number accepted; +∞ is no bound, but not in a Catalogue
  bool low_open = false;  ///< `low` itself is refused
  /// Whether a number is accepted; false for NaN.
  bool contains(double x) const { return (low_open ? x > low : x >= low) && x <= high; }
  /// Whether the same numbers are accepted.
  bool operator==(const Range&) const = default;
};

/// The range 0 < x ≤ high.
constexpr Range positive(double high) { return {.low = 0.0, .high = high, .low_open = true}; }
/// The range low ≤ x ≤ high.
constexpr Range between(double low, double high) { return {.low = low, .high = high}; }

/// The range as part of an error message: `must be > 0 and <= 10`.
std::string to_string(const Range& range);

/// Longest value of an option of kind kText.
inline constexpr std::size_t kMaxOptionText = 200;

/// One key that a component (a driver, a control method, a planning method) reads from its section
/// of the mission file.
struct OptionSpec {
  /// Type of the values.
  enum class Kind : std::uint8_t {
    kNumber,  ///< finite number within `range`
    kCount,   ///< whole number within `range`, which must lie in [0, 2³²)
    kChoice,  ///< one of `choices`
    kText     ///< printable ASCII of at most kMaxOptionText characters, as an address or a name
  };
  std::string key;                     ///< key in the mission file, with its unit: "gain_hz"
  Kind kind = Kind::kNumber;           ///< type of its values
  std::string fallback;                ///< default, as a mission file would write it
  Range range{};                       ///< accepted values of a number or count
  std::vector<std::string> choices{};  ///< accepted values of a choice
  std::string doc;                     ///< one line for help and documentation
  std::string at_most{};  ///< key of the section that its number must not exceed, if any
  /// Whether all members are the same: only then may two components share a key.
  bool operator==(const OptionSpec&) const = default;
};

/// Values of a component's options by key, as they are written in a mission file. The reader of
/// the file has checked them against their specs (not in an open section of a Catalogue); options
/// that the file does not set are not in it. OptionTable::read() fills in the defaults.
class OptionValues {
 public:
  /// Sets a value as text, replacing one that is there.
  void set(std::string_view key, std::string text);
  /// Sets a number, as the shortest decimal that reads back to the same double.
  void set(std::string_view key, double value);
  /// The text of a value; null if it is not set. O(log n).
  const std::string* find(std::string_view key) const;
  /// A value as a number; empty if it is not set or not a number.
  std::optional<double> number(std::string_view key) const;
  /// All values that are set, by ascending key.
  const std::map<std::string, std::string, std::less<>>& all() const { return values_; }
  /// Whether the same keys are set to the same texts.
  bool operator==(const OptionValues&) const = default;

 private:
  std::map<std::string, std::string, std::less<>> values_;
};

}  // namespace swarm
