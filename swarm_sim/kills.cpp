// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_sim/kills.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "swarmflow/core/random.hpp"

namespace swarm::launcher {
namespace {

tl::unexpected<Error> refuse(std::string_view text) {
  return fail(ErrorCode::kBadInput,
              fmt::format("--kill: '{}'; write it like 10@60 or ids:3,7@60 or "
                          "10@60,in=90:40:110:60 (the robots inside x0:y0:x1:y1)",
                          text));
}

/// Reads a text that is one finite number as a whole; nothing else may follow.
template <class Number>
std::optional<Number> number(std::string_view text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end) return std::nullopt;
  if constexpr (std::is_floating_point_v<Number>) {
    if (!std::isfinite(value)) return std::nullopt;
  }
  return value;
}

/// Removes the part up to a separator, and the separator, from the text; returns the part.
std::string_view take_until(std::string_view& text, char separator) {
  const std::string_view part = text.substr(0, text.find(separator));
  text.remove_prefix(std::min(text.size(), part.size() + 1));
  return part;
}

/// Whether a part ends with a separator: take_until() finds nothing behind it, as at a proper end.
bool is_unfinished(std::string_view part) { return part.ends_with(',') || part.ends_with(':'); }

/// `x0:y0:x1:y1` with x0 < x1 and y0 < y1.
std::optional<Box> read_box(std::string_view text) {
  std::array<double, 4> numbers{};
  for (double& value : numbers) {
    const auto read = number<double>(take_until(text, ':'));
    if (!read) return std::nullopt;
    value = *read;
  }
  const Box box{.min_m = {numbers[0], numbers[1]}, .max_m = {numbers[2], numbers[3]}};
  const bool ordered = (box.min_m.array() < box.max_m.array()).all();
  return text.empty() && ordered ? std::optional(box) : std::nullopt;
}

}  // namespace

/// WHOM@SECONDS with an optional box behind a comma; a list of ids allows no box.
Result<Kill> parse_kill(std::string_view text) {
  constexpr std::string_view kIds = "ids:";
  constexpr std::string_view kIn = "in=";
  Kill kill;
  std::string_view rest = text;
  std::string_view whom = take_until(rest, '@');
  const auto at_s = number<double>(take_until(rest, ','));
  if (!at_s || *at_s < 0.0 || is_unfinished(text) || is_unfinished(whom)) return refuse(text);
  kill.at_s = *at_s;
  if (whom.starts_with(kIds)) {
    for (whom.remove_prefix(kIds.size()); !whom.empty();) {
      const auto id = number<std::uint32_t>(take_until(whom, ','));
      if (!id) return refuse(text);
      kill.robots.emplace_back(*id);
    }
    if (kill.robots.empty() || !rest.empty()) return refuse(text);
    return kill;
  }
  const auto count = number<std::uint32_t>(whom);
  if (!count || *count == 0) return refuse(text);
  kill.count = *count;
  if (rest.empty()) return kill;
  if (!rest.starts_with(kIn)) return refuse(text);
  kill.in_m = read_box(rest.substr(kIn.size()));
  if (!kill.in_m) return refuse(text);
  return kill;
}

std::vector<RobotId> choose(const Kill& kill, std::span<const Candidate> living,
                            std::uint64_t seed) {
  const auto is_asked_for = [&](const Candidate& c) {
    if (kill.robots.empty()) return !kill.in_m || kill.in_m->contains(c.position_m);
    return std::find(kill.robots.begin(), kill.robots.end(), c.robot) != kill.robots.end();
  };
  std::vector<RobotId> chosen;
  for (const Candidate& candidate : living) {
    if (is_asked_for(candidate)) chosen.push_back(candidate.robot);
  }
  if (!kill.robots.empty() || chosen.size() <= kill.count) return chosen;
  // Each robot has a random number of its own, and the smallest are chosen: which other robots are
  // candidates does not change a robot's number.
  std::sort(chosen.begin(), chosen.end(), [&](RobotId a, RobotId b) {
    return mix_seed(seed, a.value()) < mix_seed(seed, b.value());
  });
  chosen.resize(kill.count);
  // By id again, as the header states.
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace swarm::launcher
