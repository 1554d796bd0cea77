// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <array>

#include <fmt/format.h>

#include "swarm_launcher/table/experiments.hpp"

namespace swarm::launcher {

Result<void> swarmprm_experiment(Rows& rows) {
  struct Published {
    std::uint32_t robots;
    const char* cells;  // SwarmPRM, formation control, dRRT*, ADOC
  };
  constexpr std::array<Published, 4> kPublished{{
      {20, "3.4 / 241.6 | 2.2 / 305.2 | 90 / 229.8 | 6.4 / 295.6"},
      {40, "3.5 / 240.7 | 5.3 / 312.5 | 90 / 408.1 | 6.9 / 292.1"},
      {100, "3.9 / 237.1 | 8.6 / 304.0 | none | 7.5 / 282.5"},
      {500, "7.1 / 236.1 | 54.6 / 309.3 | none | 13.2 / 279.0"},
  }};
  auto mission = rows.load("swarmprm_standin");
  if (!mission) return tl::unexpected(mission.error());
  for (const Published& p : kPublished) {
    if (rows.quick() && p.robots > 40) break;
    mission->robots.count = p.robots;
    const std::uint32_t seeds = rows.quick() ? 1 : 5;
    if (auto added = rows.add(fmt::format("{}", p.robots), p.cells, *mission, seeds); !added) {
      return added;
    }
  }
  rows.say_rows("N", "SwarmPRM min / m | formation control | dRRT* | ADOC");
  return {};
}

}  // namespace swarm::launcher
