// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission/link_faults.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "swarmflow/core/random.hpp"

namespace swarm {
namespace {

// Bounds that keep the conversion to nanoseconds far from overflow.
constexpr double kMaxDelay_ms = 60'000.0;
constexpr double kMaxTime_s = 1e6;

tl::unexpected<Error> refuse(std::string_view pair, std::string_view why) {
  return fail(
      ErrorCode::kBadInput,
      fmt::format(
          "--fault: '{}' {}; write it like loss=0.2,delay-ms=150,jitter-ms=50,from=10,to=60", pair,
          why));
}

}  // namespace

// Parses pair by pair without copies. from_chars() is used because it does not depend on the
// locale.
Result<LinkFaults> parse_link_faults(std::string_view text) {
  LinkFaults faults;
  while (!text.empty()) {
    const std::string_view pair = text.substr(0, text.find(','));
    text.remove_prefix(std::min(text.size(), pair.size() + 1));
    const std::size_t equals = std::min(pair.find('='), pair.size());
    const std::string_view key = pair.substr(0, equals);
    double value = 0.0;
    const char* const end = pair.data() + pair.size();
    const char* const begin = std::min(pair.data() + equals + 1, end);
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error != std::errc{} || stop != end || !std::isfinite(value)) {
      return refuse(pair, "is not KEY=NUMBER");
    }
    const bool is_ms = key == "delay-ms" || key == "jitter-ms";
    const double largest = key == "loss" ? 1.0 : is_ms ? kMaxDelay_ms : kMaxTime_s;
    if (value < 0.0 || value > largest) {
      return refuse(pair, fmt::format("is not in 0 to {}", largest));
    }
    if (key == "loss") {
      faults.loss = value;
    } else if (key == "delay-ms") {
      faults.delay = from_seconds(1e-3 * value);
    } else if (key == "jitter-ms") {
      faults.jitter = from_seconds(1e-3 * value);
    } else if (key == "from") {
      faults.from = from_seconds(value);
    } else if (key == "to") {
      faults.until = from_seconds(value);
    } else {
      return refuse(pair, "has an unknown key");
    }
  }
  if (faults.until <= faults.from) return refuse("to", "is not after 'from'");
  return faults;
}

// A hash in place of a random generator: the fate of a message depends neither on the order of the
// messages nor on the number of receivers. The low 32 bits decide on loss and the high 32 bits on
// jitter, so the two are independent.
std::optional<Duration> fate(const LinkFaults& faults, std::uint64_t seed, std::uint64_t message) {
  constexpr double kScale = 0x1.0p-32;
  const std::uint64_t drawn = mix_seed(seed, message);
  if (static_cast<double>(drawn & 0xFFFFFFFFU) * kScale < faults.loss) return std::nullopt;
  // Uniform in [−1, 1).
  const double turn = 2.0 * (static_cast<double>(drawn >> 32U) * kScale) - 1.0;
  const Duration jitter(std::llround(turn * static_cast<double>(faults.jitter.count())));
  return std::max(Duration::zero(), faults.delay + jitter);
}

}  // namespace swarm
