// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/table/table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "swarm_core/mission/mission_file.hpp"
#include "swarm_core/shell/run_directory.hpp"
#include "swarm_launcher/table/flown.hpp"

namespace swarm::launcher {
namespace {

/// What seeds have in common.
struct Row {
  std::string name;
  std::string published;  ///< cells of the papers, ready to print
  std::vector<Flown> flown;

  template <class Of>
  double mean(Of of) const {
    double sum = 0.0;
    for (const Flown& f : flown) sum += of(f);
    return sum / static_cast<double>(flown.size());
  }
  template <class Of>
  double deviation(Of of) const {
    const double m = mean(of);
    return std::sqrt(mean([&](const Flown& f) { return (of(f) - m) * (of(f) - m); }));
  }
  template <class Of>
  double least(Of of) const {
    double low = of(flown.front());
    for (const Flown& f : flown) low = std::min(low, of(f));
    return low;
  }
  bool good() const {
    return std::all_of(flown.begin(), flown.end(),
                       [](const Flown& f) { return f.arrived == f.robots && f.contacts == 0; });
  }
  double arrived() const {
    return 100.0 * mean([](const Flown& f) { return 1.0 * f.arrived / f.robots; });
  }
  double contacts() const {
    return mean([](const Flown& f) { return 1.0 * f.contacts; });
  }

  std::string ours() const {
    return fmt::format(
        "{:.2f} | {:.1f} ({:.2f}) | {:.3f} | {:.0f} | {:.4g} | {:.3g} | {:.2f} / {:.2f}",
        mean([](const Flown& f) { return f.wall_s; }),
        mean([](const Flown& f) { return f.path_m; }),
        deviation([](const Flown& f) { return f.path_m; }),
        mean([](const Flown& f) { return f.ratio(); }),
        mean([](const Flown& f) { return f.mission_s; }), arrived(), contacts(),
        least([](const Flown& f) { return f.robot_gap_m; }),
        least([](const Flown& f) { return f.obstacle_gap_m; }));
  }

  nlohmann::ordered_json to_json() const {
    nlohmann::ordered_json seeds = nlohmann::ordered_json::array();
    for (const Flown& f : flown) {
      seeds.push_back({{"seed", f.seed},
                       {"outcome", to_string(f.outcome)},
                       {"robots", f.robots},
                       {"arrived", f.arrived},
                       {"contacts", f.contacts},
                       {"wall_s", f.wall_s},
                       {"plan_ms", f.plan_ms},
                       {"ns_per_agent_step", f.ns_per_agent_step},
                       {"mission_s", f.mission_s},
                       {"mean_path_m", f.path_m},
                       {"path_ratio", f.ratio()},
                       {"min_robot_gap_m", f.robot_gap_m},
                       {"min_obstacle_gap_m", f.obstacle_gap_m},
                       {"clearance_m", f.clearance_m},
                       {"risk_share", f.risk_share}});
    }
    return {{"name", name}, {"seeds", std::move(seeds)}};
  }
};

constexpr std::string_view kOurs =
    "wall s | mean path m (std) | / bound | mission s | arrived % | contacts | least gap robot / "
    "obstacle m";

class Table {
 public:
  explicit Table(const TableOptions& options) : options_(options) {}

  Result<void> add(const std::string& name, const std::string& published, const Mission& mission,
                   std::uint32_t seeds) {
    std::fprintf(stderr, "%s: %u robots, %u seed(s)\n", name.c_str(), mission.robots.count, seeds);
    auto flown = fly_seeds(mission, seeds);
    if (!flown) return tl::unexpected(flown.error());
    rows_.push_back({name, published, *std::move(flown)});
    return {};
  }

  Result<Mission> load(const std::string& name) const {
    return load_mission(options_.missions / (name + ".yaml"));
  }

  const std::vector<Row>& rows() const { return rows_; }
  void say(const std::string& line) { text_ += line + "\n"; }

  void say_rows(std::string_view head, std::string_view published_head) {
    const std::string columns = fmt::format("{} | {} | {}", head, published_head, kOurs);
    say("| " + columns + " |");
    std::string rule = "|";
    for (std::size_t i = 0;
         i <= static_cast<std::size_t>(std::count(columns.begin(), columns.end(), '|')); ++i) {
      rule += "---|";
    }
    say(rule);
    for (const Row& row : rows_) {
      say(fmt::format("| {} | {} | {} |", row.name, row.published, row.ours()));
    }
  }

  Result<ExitCode> finish() const {
    std::fputs(text_.c_str(), stdout);
    const bool good =
        std::all_of(rows_.begin(), rows_.end(), [](const Row& r) { return r.good(); });
    if (!options_.out.empty()) {
      std::error_code error;
      std::filesystem::create_directories(options_.out, error);
      nlohmann::ordered_json json = nlohmann::ordered_json::array();
      for (std::size_t i = 0; i < rows_.size(); ++i) {
        json.push_back(rows_[i].to_json());
        const auto picture = options_.out / fmt::format("{}-{:02}.svg", options_.which, i);
        if (auto w = shell::write_file(picture, rows_[i].flown.front().paths_svg); !w) {
          return tl::unexpected(w.error());
        }
      }
      for (const auto& [suffix, content] :
           {std::pair{".md", text_}, std::pair{".json", json.dump(2) + "\n"}}) {
        if (auto w = shell::write_file(options_.out / (options_.which + suffix), content); !w) {
          return tl::unexpected(w.error());
        }
      }
    }
    return good ? ExitCode::kOk : ExitCode::kCriteriaNotMet;
  }

 private:
  const TableOptions& options_;
  std::vector<Row> rows_;
  std::string text_;
};

Result<void> swarmprm(Table& table, bool quick) {
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
  auto mission = table.load("swarmprm_standin");
  if (!mission) return tl::unexpected(mission.error());
  for (const Published& p : kPublished) {
    if (quick && p.robots > 40) break;
    mission->robots.count = p.robots;
    if (auto added = table.add(fmt::format("{}", p.robots), p.cells, *mission, quick ? 1 : 5);
        !added) {
      return added;
    }
  }
  table.say_rows("N", "SwarmPRM min / m | formation control | dRRT* | ADOC");
  return {};
}

Result<void> rover(Table& table, bool quick) {
  constexpr std::array<const char*, 3> kPublished{
      "4.28 / 170.05 / .32 / .49 | 41.35 / 269.40 / .23 / 1.96 | 66.60 / 160.11 / .078 / -0.45",
      "5.44 / 198.67 / .62 / .76 | 44.51 / 279.70 / .23 / 7.00 | 116.76 / 162.09 / .02 / -6.57",
      "6.05 / 202.26 / .58 / .34 | 58.58 / 364.16 / .23 / 6.80 | 120.78 / 159.03 / .03 / -2.96"};
  const std::uint32_t robots = quick ? 60 : 500;
  for (std::size_t i = 0; i < kPublished.size(); ++i) {
    auto mission = table.load(fmt::format("rover_scenario{}_standin", i + 1));
    if (!mission) return tl::unexpected(mission.error());
    mission->robots.count = robots;
    if (auto added = table.add(fmt::format("scenario {}", i + 1), kPublished[i], *mission, 1);
        !added) {
      return added;
    }
  }
  auto mission = table.load("rover_scenario2_standin");
  if (!mission) return tl::unexpected(mission.error());
  mission->robots.count = robots;
  constexpr std::array<std::pair<double, const char*>, 3> kAlphas{
      {{0.05, "5.50 / 191.0"}, {0.15, "4.20 / 174.6"}, {0.3, "3.81 / 173.2"}}};
  for (const auto& [alpha, published] : kAlphas) {
    mission->planner.risk_alpha = alpha;
    if (auto added = table.add(fmt::format("scenario 2, α = {}", alpha),
                               fmt::format("{} | |", published), *mission, 1);
        !added) {
      return added;
    }
  }
  table.say_rows("case", "ROVER min / m / gap robot / obstacle | formation | predictive");
  table.say(
      "\n| α | mean of robots' least clearance m | robot-time nearer than 0.2 m, promised ≤ α | / "
      "bound |\n|---|---|---|---|");
  for (std::size_t i = 0; i < kAlphas.size(); ++i) {
    const Flown& f = table.rows()[3 + i].flown.front();
    table.say(fmt::format("| {} | {:.3f} | {:.5f} | {:.4f} |", kAlphas[i].first, f.clearance_m,
                          f.risk_share, f.ratio()));
  }
  return {};
}

/// R² of the straight line through (x, y).
double linearity(const std::vector<double>& x, const std::vector<double>& y) {
  const auto mean = [](const std::vector<double>& v) {
    double sum = 0.0;
    for (const double value : v) sum += value;
    return sum / static_cast<double>(v.size());
  };
  const double mx = mean(x);
  const double my = mean(y);
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mx) * (x[i] - mx);
    xy += (x[i] - mx) * (y[i] - my);
    yy += (y[i] - my) * (y[i] - my);
  }
  return xy * xy / (xx * yy);
}

Result<void> crops(Table& table, bool quick) {
  struct Map {
    const char* name;
    std::array<const char*, 4> cells;  // of the authors' own runs: all arrived of 20, wall s
  };
  const std::array<Map, 4> maps{{
      {"crops_scene1", {"20/20, 1.6 s", "17/20, 4.5 s", "19/20, 9.7 s", ""}},
      {"crops_spiral", {"19/20, 6.4 s", "16/20, 17.9 s", "14/20, 32.5 s", ""}},
      {"crops_scene3", {"17/20, 6.3 s", "13/20, 16.9 s", "17/20, 32.5 s", ""}},
      {"crops_s", {"", "", "", ""}},
  }};
  constexpr std::array<std::uint32_t, 4> kRobots{10, 30, 50, 100};
  std::string lines;
  for (const Map& map : maps) {
    auto mission = table.load(map.name);
    if (!mission) return tl::unexpected(mission.error());
    std::vector<double> n, wall_s;
    for (std::size_t i = 0; i < kRobots.size() && !(quick && i > 0); ++i) {
      mission->robots.count = kRobots[i];
      if (auto added = table.add(fmt::format("{} {}", map.name, kRobots[i]), map.cells[i], *mission,
                                 quick ? 2 : 20);
          !added) {
        return added;
      }
      n.push_back(kRobots[i]);
      wall_s.push_back(table.rows().back().mean([](const Flown& f) { return f.wall_s; }));
    }
    if (n.size() > 2) lines += fmt::format("| {} | {:.3f} |\n", map.name, linearity(n, wall_s));
  }
  table.say_rows("map, N", "authors: all arrived, wall");
  if (!lines.empty()) table.say("\n| map | R² of wall time over N |\n|---|---|\n" + lines);
  return {};
}

Result<void> diffusion(Table& table, bool quick) {
  for (const char* name : {"diffusion_q", "diffusion_jie"}) {
    auto mission = table.load(name);
    if (!mission) return tl::unexpected(mission.error());
    if (auto added =
            table.add(name, fmt::format("{}", mission->robots.count), *mission, quick ? 1 : 20);
        !added) {
      return added;
    }
    if (quick) break;
  }
  table.say_rows("shape", "N");
  return {};
}

}  // namespace

Result<ExitCode> make_table(const TableOptions& options) {
  Table table(options);
  const Result<void> made = options.which == "swarmprm" ? swarmprm(table, options.quick)
                            : options.which == "rover"  ? rover(table, options.quick)
                            : options.which == "crops"  ? crops(table, options.quick)
                                                        : diffusion(table, options.quick);
  if (!made) return tl::unexpected(made.error());
  return table.finish();
}

}  // namespace swarm::launcher
