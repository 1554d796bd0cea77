// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// ROVER over whole missions, a JSON object a mission: time of the steps (all iterations of the
// sequential program of a step together), iterations, risk, path. With --export, the last linear
// program of every step, for rover_check.py.
#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "planner_service/flow/transport_lp.hpp"
#include "planner_service/methods/rover/rover.hpp"
#include "swarm_core/metrics/shortest_paths.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace {

using swarm::Mission;
using swarm::planner::LinearProgram;
using swarm::planner::Rover;
using swarm::planner::RoverOptions;
using swarm::planner::RoverStep;

struct Settings {
  RoverOptions rover;
  int repeat = 5;
  std::string export_to;
};

double wall_ms() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double, std::milli>(now).count();
}

// CPU time of this thread, which does not contain that of other processes.
double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

double mean_path_m(const swarm::FlowPlan& plan) {
  double sum_m = 0.0;
  for (const swarm::PlanLeg& leg : plan.legs()) {
    sum_m +=
        leg.mass *
        (plan.nodes()[leg.to].gaussian.mean_m() - plan.nodes()[leg.from].gaussian.mean_m()).norm();
  }
  return sum_m;
}

// Cheapest assignment of the means along shortest paths around the obstacles.
double mean_bound_m(const Mission& mission) {
  std::vector<swarm::Vec2> from, to;
  std::vector<double> supplies, demands;
  for (const auto& [weight, g] : mission.start.components()) {
    from.push_back(g.mean_m());
    supplies.push_back(weight);
  }
  for (const auto& [weight, g] : mission.goal.components()) {
    to.push_back(g.mean_m());
    demands.push_back(weight);
  }
  const std::vector<double> costs_m =
      swarm::ShortestPaths(mission.world, mission.robots.radius_m).distances_m(from, to);
  const auto shipments = swarm::planner::solve_transport(supplies, demands, costs_m);
  if (!shipments) return std::numeric_limits<double>::infinity();
  double bound_m = 0.0;
  for (const auto& s : *shipments) bound_m += s.mass * costs_m[s.from * to.size() + s.to];
  return bound_m;
}

// Largest GMM-CVaR at ten times in every step.
double fine_cvar_m(const swarm::FlowPlan& plan, const swarm::World& world, double alpha) {
  std::vector<double> times_s;
  for (const auto& node : plan.nodes()) times_s.push_back(node.time.count());
  std::sort(times_s.begin(), times_s.end());
  times_s.erase(std::unique(times_s.begin(), times_s.end()), times_s.end());
  double worst_m = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    for (int k = 1; k <= 10; ++k) {
      const swarm::MissionTime t(times_s[i - 1] + (times_s[i] - times_s[i - 1]) * k / 10.0);
      worst_m = std::max(worst_m, max_mixture_cvar_m(plan.mixture_at(t), world, alpha));
    }
  }
  return worst_m;
}

void export_program(const RoverStep& step, const std::string& file) {
  const LinearProgram& lp = step.horizon.program;
  nlohmann::json json{{"cost", lp.cost},           {"column_start", lp.column_start},
                      {"row_index", lp.row_index}, {"value", lp.value},
                      {"row_upper", lp.row_upper}, {"optimum", step.horizon.optimum}};
  json["is_equality"] = nlohmann::json::array();
  for (const double lower : lp.row_lower) {
    json["is_equality"].push_back(lower > -std::numeric_limits<double>::infinity());
  }
  std::ofstream(file) << json.dump();
}

int fail(const std::string& file, const swarm::Error& error) {
  fmt::print(stderr, "{}: {}\n", file, error.message);
  return 1;
}

int run(const std::string& file, const Settings& settings) {
  auto mission = swarm::load_mission(file);
  if (!mission) return fail(file, mission.error());
  RoverOptions options = settings.rover;
  options.mpc.robots = mission->robots.count;
  options.mpc.keep_program = !settings.export_to.empty();
  const double begin_ms = wall_ms();
  auto rover = Rover::make(mission->world, mission->goal, options);
  if (!rover) return fail(file, rover.error());
  const double offline_ms = wall_ms() - begin_ms;
  auto planned = rover->plan(mission->start);
  if (!planned) return fail(file, planned.error());

  // Once more, step by step, as in a run.
  std::vector<double> cpu, wall, iterations, pivots, columns;
  double step_cvar_m = -std::numeric_limits<double>::infinity();
  for (int r = 0; r < settings.repeat; ++r) {
    rover->forget();
    swarm::Mixture current = mission->start;
    for (std::size_t k = 0; k < planned->steps.size(); ++k) {
      const double from_cpu = cpu_ms();
      const double from_wall = wall_ms();
      auto step = rover->step(current);
      wall.push_back(wall_ms() - from_wall);
      cpu.push_back(cpu_ms() - from_cpu);
      if (!step) return fail(file, step.error());
      for (const double cvar_m : step->cvar_m) step_cvar_m = std::max(step_cvar_m, cvar_m);
      iterations.push_back(step->horizon.iterations);
      pivots.push_back(step->horizon.pivots);
      columns.push_back(step->horizon.columns);
      if (r == 0 && options.mpc.keep_program) {
        export_program(*step,
                       fmt::format("{}/{}_{:02}.json", settings.export_to, mission->name, k));
      }
      current = step->to;
    }
  }
  const double path_m = mean_path_m(planned->plan);
  const nlohmann::ordered_json json{
      {"mission", mission->name},
      {"alpha", options.graph.risk.alpha},
      {"checks_between", options.graph.checks_between},
      {"gaussians", rover->graph().own_vertices()},
      {"offline_ms", offline_ms},
      {"steps", planned->steps.size()},
      {"duration_s", planned->plan.duration().count()},
      {"step_cpu_ms_p50", percentile(cpu, 0.5)},
      {"step_cpu_ms_p99", percentile(cpu, 0.99)},
      {"step_wall_ms_p50", percentile(wall, 0.5)},
      {"step_wall_ms_p99", percentile(wall, 0.99)},
      {"iterations_p50", percentile(iterations, 0.5)},
      {"iterations_max", percentile(iterations, 1.0)},
      {"pivots_p50", percentile(pivots, 0.5)},
      {"pivots_max", percentile(pivots, 1.0)},
      {"columns_max", percentile(columns, 1.0)},
      {"step_cvar_m", step_cvar_m},
      {"fine_cvar_m", fine_cvar_m(planned->plan, mission->world, options.graph.risk.alpha)},
      {"mean_path_m", path_m},
      {"ratio", path_m / mean_bound_m(*mission)},
      {"nodes", planned->plan.nodes().size()},
      {"legs", planned->plan.legs().size()}};
  fmt::print("{}\n", json.dump());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  std::vector<std::string> files;
  CLI::App app{"ROVER over whole missions"};
  app.add_option("missions", files, "mission files")->required();
  app.add_option("--alpha", settings.rover.graph.risk.alpha);
  app.add_option("--horizon", settings.rover.mpc.costs.horizon);
  app.add_option("--radius", settings.rover.graph.transport_radius_m);
  app.add_option("--risk-weight", settings.rover.graph.risk_weight);
  app.add_option("--between", settings.rover.graph.checks_between);
  app.add_option("--cap", settings.rover.mpc.density_cap_per_m2);
  app.add_option("--repeat", settings.repeat);
  app.add_option("--export", settings.export_to, "folder for the linear programs");
  CLI11_PARSE(app, argc, argv);
  int failed = 0;
  for (const std::string& file : files) failed += run(file, settings);
  return failed == 0 ? 0 : 1;
}
