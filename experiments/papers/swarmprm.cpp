// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "experiments/papers/experiments.hpp"

namespace swarm::launcher {

namespace {

/// Ablations: the same flights with one feature switched off or changed. They are flown in turns,
/// so that their times can be compared; all but the first may fail.
Result<void> add_ablations(Rows& rows, Mission mission) {
  const std::uint32_t robots = rows.quick() ? 40 : 500;
  const std::uint32_t seeds = rows.quick() ? 1 : 3;
  mission.robots.count = robots;
  mission.planner.density_cap_per_m2 = 1.5;
  std::vector<Rows::Named> names;
  std::vector<Mission> missions;
  const auto add = [&](const std::string& what, const Mission& m) {
    names.push_back({fmt::format("{}, {}", robots, what), "| | |"});
    missions.push_back(m);
  };
  // Each mission differs from the first in one respect, those without a cap from each other.
  add("cap 1.5", mission);
  Mission free = mission;
  free.control.options.set("tracking", "free");
  add("cap 1.5, tracking free", free);
  Mission dense = mission;
  dense.control.options.set("density_push_mps", 0.3);
  add("cap 1.5, density term 0.3 m/s", dense);
  Mission close = mission;
  close.control.options.set("neighbour_push_mps", 0.0);
  add("cap 1.5, no repulsion", close);
  Mission uncapped = mission;
  uncapped.planner.density_cap_per_m2 = 0.0;
  add("no cap", uncapped);
  Mission uncapped_free = uncapped;
  uncapped_free.control.options.set("tracking", "free");
  add("no cap, tracking free", uncapped_free);
  if (auto added = rows.add_in_turns(names, missions, seeds); !added) return added;
  rows.may_fail(missions.size() - 1);  // all but the first
  return {};
}

}  // namespace

/// Four swarm sizes with the published numbers beside them, then the ablations.
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
  if (auto added = add_ablations(rows, *mission); !added) return added;
  rows.add_line(
      "Stand-in map: the paper prints no obstacles. Its columns are minutes and metres on its "
      "own map; compare path / bound.\n");
  rows.add_published_rows("N", "SwarmPRM min / m | formation control | dRRT* | ADOC");
  return {};
}

}  // namespace swarm::launcher
