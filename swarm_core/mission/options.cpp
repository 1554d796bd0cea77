// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/mission/options.hpp"

#include <charconv>
#include <limits>
#include <utility>

#include <fmt/format.h>

namespace swarm {

std::string to_string(const Range& range) {
  const std::string low = fmt::format("{} {}", range.low_open ? ">" : ">=", range.low);
  if (range.high == std::numeric_limits<double>::infinity()) return "must be " + low;
  return fmt::format("must be {} and <= {}", low, range.high);
}

void OptionValues::set(std::string_view key, std::string text) {
  values_.insert_or_assign(std::string(key), std::move(text));
}

void OptionValues::set(std::string_view key, double value) {
  set(key, fmt::format("{}", value));  // the shortest decimal that reads back to the same double
}

const std::string* OptionValues::find(std::string_view key) const {
  const auto found = values_.find(key);
  return found == values_.end() ? nullptr : &found->second;
}

// from_chars() does not accept the leading '+' that YAML allows, so it is removed first.
std::optional<double> OptionValues::number(std::string_view key) const {
  const std::string* text = find(key);
  if (text == nullptr) return std::nullopt;
  std::string_view digits = *text;
  if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

}  // namespace swarm
