// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <array>

#include <fmt/format.h>

#include "experiments/papers/experiments.hpp"
#include "experiments/papers/figure.hpp"

namespace swarm::launcher {
namespace {

/// A map with the published results for the first swarm sizes.
struct Map {
  const char* name;
  std::array<const char*, 4> cells;  // of the authors' own runs: all arrived of 20, wall s
};

constexpr std::array<Map, 4> kMaps{{
    {"crops_scene1", {"20/20, 1.6 s", "17/20, 4.5 s", "19/20, 9.7 s", ""}},
    {"crops_spiral", {"19/20, 6.4 s", "16/20, 17.9 s", "14/20, 32.5 s", ""}},
    {"crops_scene3", {"17/20, 6.3 s", "13/20, 16.9 s", "17/20, 32.5 s", ""}},
    {"crops_s", {"", "", "", ""}},
}};
// Swarm sizes; the authors published results for the first three.
constexpr std::array<std::uint32_t, 4> kSwarmSizes{10, 30, 50, 100};

/// R² of the least-squares line through the points: how linear wall time is in N.
double linearity(const std::vector<Vec2>& points) {
  Vec2 mean = Vec2::Zero();
  for (const Vec2& p : points) mean += p / static_cast<double>(points.size());
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const Vec2& p : points) {
    const Vec2 d = p - mean;
    xx += d.x() * d.x();
    xy += d.x() * d.y();
    yy += d.y() * d.y();
  }
  return xy * xy / (xx * yy);
}

}  // namespace

/// All swarm sizes of a map are flown in turns: their wall times are compared with each other.
Result<void> crops_experiment(Rows& rows) {
  std::vector<Line> lines;
  for (const Map& map : kMaps) {
    auto mission = rows.load(map.name);
    if (!mission) return tl::unexpected(mission.error());
    std::vector<Rows::Named> named;
    std::vector<Mission> missions;
    for (std::size_t i = 0; i < kSwarmSizes.size() && !(rows.quick() && i > 0); ++i) {
      named.push_back({fmt::format("{} {}", map.name, kSwarmSizes[i]), map.cells[i]});
      missions.push_back(*mission);
      missions.back().robots.count = kSwarmSizes[i];
    }
    if (auto added = rows.add_in_turns(named, missions, rows.quick() ? 2 : 20); !added) {
      return added;
    }
    Line line{.name = map.name, .points = {}, .dots = true};
    for (const Row& row : rows.newest(missions.size())) {
      line.points.emplace_back(row.flown.front().robots,
                               row.median([](const Flown& f) { return f.wall_s; }));
    }
    lines.push_back(std::move(line));
  }
  rows.add_published_rows("map, N", "authors: all arrived, wall");
  if (rows.quick()) return {};
  rows.add_line("\n| map | R² of wall time (median) over N |\n|---|---|");
  for (const Line& line : lines) {
    rows.add_line(fmt::format("| {} | {:.3f} |", line.name, linearity(line.points)));
  }
  rows.draw(
      "wall-time",
      figure({.title = "Wall time of a whole mission, median of 20 seeds", .x = "robots", .y = "s"},
             lines));
  return {};
}

}  // namespace swarm::launcher
