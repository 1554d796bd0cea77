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
  return fail(ErrorCode::kBadInput,
              fmt::format("--fault: '{}' {}; write it like loss=0.2,delay-ms=150,jitter-ms=50,"
                          "duplicate=0.1,from=10,to=60,robots=3-5,launcher=1",
                          pair, why));
}

/// Reads the whole of a text as a number. from_chars() does not depend on the locale.
template <class Number>
bool read_number(std::string_view text, Number& out) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, out);
  return error == std::errc{} && stop == end && !text.empty();
}

/// `3-5`, or `3` alone.
bool read_robots(std::string_view text, LinkFaults& faults) {
  const std::size_t dash = std::min(text.find('-'), text.size());
  const std::string_view first = text.substr(0, dash);
  const std::string_view last = dash < text.size() ? text.substr(dash + 1) : first;
  return read_number(first, faults.first_robot) && read_number(last, faults.last_robot) &&
         faults.first_robot <= faults.last_robot && faults.last_robot != LinkFaults::kAllRobots;
}

/// The largest value of a key with a number; nothing if there is no such key.
std::optional<double> largest(std::string_view key) {
  if (key == "loss" || key == "duplicate" || key == "launcher") return 1.0;
  if (key == "delay-ms" || key == "jitter-ms") return kMaxDelay_ms;
  if (key == "from" || key == "to") return kMaxTime_s;
  return std::nullopt;
}

/// \pre the key has a largest value
void set(LinkFaults& faults, std::string_view key, double value) {
  if (key == "loss") faults.loss = value;
  if (key == "duplicate") faults.duplicate = value;
  if (key == "launcher") faults.at_launcher = value > 0.0;
  if (key == "delay-ms") faults.delay = from_seconds(1e-3 * value);
  if (key == "jitter-ms") faults.jitter = from_seconds(1e-3 * value);
  if (key == "from") faults.from = from_seconds(value);
  if (key == "to") faults.until = from_seconds(value);
}

}  // namespace

// Parses pair by pair without copies.
Result<LinkFaults> parse_link_faults(std::string_view text) {
  LinkFaults faults;
  while (!text.empty()) {
    const std::string_view pair = text.substr(0, text.find(','));
    text.remove_prefix(std::min(text.size(), pair.size() + 1));
    const std::size_t equals = std::min(pair.find('='), pair.size());
    const std::string_view key = pair.substr(0, equals);
    const std::string_view written = pair.substr(std::min(equals + 1, pair.size()));
    if (key == "robots") {
      if (!read_robots(written, faults)) return refuse(pair, "names no robots like 3-5");
      continue;
    }
    double value = 0.0;
    if (!read_number(written, value) || !std::isfinite(value)) {
      return refuse(pair, "is not KEY=NUMBER");
    }
    const auto most = largest(key);
    if (!most) return refuse(pair, "has an unknown key");
    if (value < 0.0 || value > *most) return refuse(pair, fmt::format("is not in 0 to {}", *most));
    set(faults, key, value);
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

std::optional<Duration> fate_of_copy(const LinkFaults& faults, std::uint64_t seed,
                                     std::uint64_t message) {
  constexpr std::uint64_t kCopies = 0xC0B1;  // random numbers of their own
  if (faults.duplicate <= 0.0) return std::nullopt;
  Rng rng(mix_seed(mix_seed(seed, kCopies), message));
  if (uniform01(rng) >= faults.duplicate) return std::nullopt;
  return fate({.delay = faults.delay, .jitter = faults.jitter}, rng(), message);
}

}  // namespace swarm
