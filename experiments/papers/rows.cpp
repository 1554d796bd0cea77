// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/papers/rows.hpp"

#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_launcher/processes/builtin_catalogue.hpp"
#include "swarm_launcher/supervision/progress.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

// Heads of the columns that cells() fills.
constexpr std::string_view kOurs =
    "plan ms | wall s | mean path m (std) | / bound | mission s | arrived % | contacts | least gap "
    "robot / obstacle m | W2 / floor | centre lag s | density flown (planned) per m2";

/// A number, or a dash where it was not measured, for instance without a timed plan.
std::string known(fmt::string_view format, double value) {
  return std::isfinite(value) ? fmt::vformat(format, fmt::make_format_args(value)) : "–";
}

/// The cells of a row: means over the seeds, but the least gaps.
std::string cells(const Row& row) {
  const auto mean = [&](auto of) { return row.mean(of); };
  return fmt::format(
      "{:.3g} | {:.3g} | {:.1f} ({:.2f}) | {:.3f} | {:.0f}{} | {:.4g} | {:.3g} | {:#.2g} / {:#.2g} "
      "| "
      "{} | {} | {}",
      mean([](const Flown& f) { return f.plan_ms; }), mean([](const Flown& f) { return f.wall_s; }),
      mean([](const Flown& f) { return f.path_m; }),
      row.deviation([](const Flown& f) { return f.path_m; }),
      mean([](const Flown& f) { return f.ratio(); }),
      mean([](const Flown& f) { return f.mission_s; }), row.all_completed() ? "" : ", time limit",
      100.0 * mean([](const Flown& f) { return 1.0 * f.arrived / f.robots; }),
      mean([](const Flown& f) { return 1.0 * f.contacts; }),
      row.least([](const Flown& f) { return f.robot_gap_m; }),
      row.least([](const Flown& f) { return f.obstacle_gap_m; }),
      known("{:.2f}", mean([](const Flown& f) { return f.w2_ratio(); })),
      known("{:+.1f}", mean([](const Flown& f) { return f.centre_lag_s; })),
      known("{:.1f}", mean([](const Flown& f) { return f.density_per_m2; })) +
          known(" ({:.1f})", mean([](const Flown& f) { return f.planned_density_per_m2; })));
}

/// All numbers of every seed, for evaluation by other programs.
nlohmann::ordered_json to_json(const Row& row) {
  nlohmann::ordered_json seeds = nlohmann::ordered_json::array();
  for (const Flown& f : row.flown) {
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
                     {"risk_share", f.risk_share},
                     {"w2_m", f.w2_m},
                     {"w2_floor_m", f.w2_floor_m},
                     {"centre_lag_s", f.centre_lag_s},
                     {"lag_p90_s", f.lag_p90_s},
                     {"density_per_m2", f.density_per_m2},
                     {"density_p95_per_m2", f.density_p95_per_m2},
                     {"planned_density_per_m2", f.planned_density_per_m2},
                     {"mission_over_plan_s", f.over_plan_s}});
  }
  return {{"name", row.name}, {"seeds", std::move(seeds)}};
}

}  // namespace

Result<Mission> Rows::load(const std::string& name) const {
  return load_mission(options_.missions / (name + ".yaml"), builtin_catalogue());
}

Result<void> Rows::add(const std::string& name, const std::string& published,
                       const Mission& mission, std::uint32_t seeds,
                       const SimulationOptions& options) {
  return add_in_turns({{name, published}}, {&mission, 1}, seeds, options);
}

/// Rows are added after all flights, in the order of the missions, so that a failed one adds none.
Result<void> Rows::add_in_turns(const std::vector<Named>& named, std::span<const Mission> missions,
                                std::uint32_t seeds, const SimulationOptions& options) {
  Progress progress;
  std::string title;
  for (std::size_t i = 0; i < missions.size(); ++i) {
    title =
        fmt::format("{}: {} robots, {} seed(s)", named[i].name, missions[i].robots.count, seeds);
    if (i + 1 < missions.size()) progress.print(title);
  }
  progress.show(title, "");
  std::size_t count = 0;
  auto flown = fly_in_turns(missions, seeds, options, [&](const Flown& f) {
    progress.show(title, fmt::format(" {} of {} flown, seed {} in {:.1f} s", ++count,
                                     missions.size() * seeds, f.seed, f.wall_s));
  });
  if (!flown) return tl::unexpected(flown.error());
  for (std::size_t i = 0; i < missions.size(); ++i) {
    rows_.push_back({named[i].name, named[i].published, std::move((*flown)[i])});
  }
  return {};
}

/// The heads contain bars of their own: the rule below them has one cell more than there are bars.
void Rows::add_published_rows(std::string_view head, std::string_view published_head) {
  const std::string columns = fmt::format("{} | {} | {}", head, published_head, kOurs);
  add_line("| " + columns + " |");
  std::string rule = "|";
  for (auto i = std::count(columns.begin(), columns.end(), '|'); i >= 0; --i) rule += "---|";
  add_line(rule);
  for (const Row& row : rows_) {
    add_line(fmt::format("| {} | {} | {} |", row.name, row.published, cells(row)));
  }
}

/// Prints the table first: it is not lost if a file cannot be written.
Result<ExitCode> Rows::finish() const {
  std::fputs(text_.c_str(), stdout);
  // The exit code is that of rows that must hold; others never fail a table.
  const bool good = std::all_of(rows_.begin(), rows_.end(), [](const Row& r) { return r.good(); });
  const ExitCode code = good ? ExitCode::kOk : ExitCode::kCriteriaNotMet;
  if (options_.out.empty()) return code;

  // An existing directory is no error; a missing one shows when the first file is written.
  std::error_code error;
  std::filesystem::create_directories(options_.out, error);
  const auto write = [&](const std::string& suffix, const std::string& content) {
    return shell::write_file(options_.out / (options_.which + suffix), content);
  };
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    json.push_back(to_json(rows_[i]));
    if (auto w = write(fmt::format("-{:02}.svg", i), rows_[i].flown.front().paths_svg); !w) {
      return tl::unexpected(w.error());
    }
  }
  for (const auto& [name, svg] : pictures_) {
    if (auto w = write("-" + name + ".svg", svg); !w) return tl::unexpected(w.error());
  }
  if (auto w = write(".md", text_); !w) return tl::unexpected(w.error());
  if (auto w = write(".json", json.dump(2) + "\n"); !w) return tl::unexpected(w.error());
  return code;
}

}  // namespace swarm::launcher
