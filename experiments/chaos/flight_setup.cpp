// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/flight_setup.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace swarm::launcher {
namespace {

// All is drawn before the kind is chosen, so that each network takes as many draws.
std::string draw_network(std::uint32_t robots, Rng& rng) {
  const double loss = uniform(rng, 0.0, 0.2), delay_ms = uniform(rng, 0.0, 100.0);
  const double from_s = uniform(rng, 3.0, 20.0), blackout_s = uniform(rng, 1.0, 4.0);
  const auto first = static_cast<std::uint32_t>(rng() % std::max(1U, robots));
  const std::uint32_t last = std::min(robots, first + std::max(1U, robots / 4)) - 1;
  const std::string cut = fmt::format("loss=1,from={:.1f},to={:.1f}", from_s, from_s + blackout_s);
  switch (rng() % 4) {
    case 0:
      return "";
    case 1:
      return fmt::format("loss={:.2f},delay-ms={:.0f},jitter-ms={:.0f}", loss, delay_ms,
                         0.3 * delay_ms);
    case 2:
      return cut;
    default:
      return cut + fmt::format(",robots={}-{}", first, std::max(first, last));
  }
}

}  // namespace

FlightSetup draw_setup(std::uint32_t robots, Rng& rng) {
  FlightSetup setup{.network = draw_network(robots, rng)};
  const auto kind = rng() % 4;
  if (robots < 4) return setup;
  setup.gateway = kind == 0;
  setup.two_hosts = kind == 1;
  return setup;
}

}  // namespace swarm::launcher
