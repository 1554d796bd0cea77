// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/supervision/summary.hpp"

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/plan/plan_json.hpp"
#include "swarm_monitor/audit/audit.hpp"
#include "swarm_monitor/report/report.hpp"

namespace swarm::launcher {
namespace {

using Json = nlohmann::ordered_json;

/// The planner writes its own times; a planner that never planned leaves none.
// Planning time, for summary.json.
Json plan_ms(const std::filesystem::path& run_dir) {
  const auto text = shell::read_file(run_dir / shell::kPlanStatsFile, 1U << 16U);
  if (!text) return nullptr;
  const Json stats = Json::parse(*text, nullptr, false);
  return stats.is_object() ? stats.value("total_ms", Json()) : Json();
}

/// By how much the published plans exceed their risk limit.
struct PlansExcess {
  std::size_t plans = 0;
  std::size_t broken = 0;
  double largest_m = 0.0;
};

// Reads all plans of the run directory: the first one and the replans, plan-*.json.
PlansExcess plans_excess(const std::filesystem::path& run_dir) {
  constexpr std::size_t kLargestPlan = 16U << 20U;
  PlansExcess excess;
  std::error_code gone;
  for (const auto& entry : std::filesystem::directory_iterator(run_dir, gone)) {
    const std::string name = entry.path().filename().string();
    const bool is_plan = name == shell::kPlanFile ||
                         (name.starts_with("plan-") && entry.path().extension() == ".json");
    if (!is_plan) continue;
    const auto text = shell::read_file(entry.path(), kLargestPlan);
    if (!text) continue;
    const double excess_m = excess_from_json(*text);
    ++excess.plans;
    excess.broken += excess_m > 0.0 ? 1 : 0;
    excess.largest_m = std::max(excess.largest_m, excess_m);
  }
  return excess;
}

/// The summary of a run that ended before any robot made a step: it has all keys, so that readers
/// of summaries need no special case.
Json empty_summary(const Json& own, const std::string& why) {
  Json summary = {{"outcome", nullptr},
                  {"reasons", {why}},
                  {"missing", Json::array()},
                  {"arrived", 0},
                  {"lost", Json::array()}};
  for (const char* key : {"robots",           "processes",           "arrived_per_goal",
                          "collisions_robot", "collisions_obstacle", "collisions_fallen",
                          "min_robot_gap_m",  "min_obstacle_gap_m",  "mean_path_m",
                          "geodesic_bound_m", "path_ratio",          "mission_s",
                          "stop_latency_ms",  "state_age_ms",        "belief_error_cm",
                          "states_hz",        "deadline_miss_ratio", "refused_messages",
                          "outside_bounds",   "damaged_records",     "tracking"}) {
    summary[key] = nullptr;
  }
  summary.update(own);
  return summary;
}

// A quorum time-out is a problem of the machine or the network rather than of the mission.
ExitCode exit_code_of(Outcome outcome, bool audit_ok) {
  switch (outcome) {
    case Outcome::kCompleted:
      return audit_ok ? ExitCode::kOk : ExitCode::kCriteriaNotMet;
    case Outcome::kQuorumTimeout:
      return ExitCode::kEnvironment;
    default:
      return ExitCode::kCriteriaNotMet;
  }
}

/// Writes the report and returns its path, or why there is none.
std::string write_report(const std::filesystem::path& run_dir,
                         const Result<monitor::AuditedRun>& audited) {
  if (!audited) return "none";
  const auto written = monitor::write_report(run_dir, *audited);
  return written ? (run_dir / "report.html").string() : "none: " + written.error().message;
}

void add_missing(monitor::Audit& audit, const std::vector<std::string>& texts) {
  for (const std::string& text : texts) {
    audit.missing.push_back(text);
    audit.reasons.push_back("missing: " + text);
  }
}

/// The launcher's part of the summary, which the audit reads and merges into its own result.
Json own_part(const std::filesystem::path& run_dir, const Measurements& measured) {
  return {{"plan_ms", measured.plan_ms ? Json(*measured.plan_ms) : plan_ms(run_dir)},
          {"discovery_s", measured.discovery_s < 0.0 ? Json() : Json(measured.discovery_s)},
          {"cpu_s", measured.cpu_s},
          {"max_rss_mb", measured.max_rss_mb},
          {"missing", measured.missing}};
}

/// Adds what only the launcher knows to the audit's result.
void complete(Json& summary, const Measurements& measured, const PlansExcess& excess) {
  if (measured.outcome != Outcome::kCompleted) summary["outcome"] = to_string(measured.outcome);
  summary["channel"] = measured.channel ? to_string(*measured.channel) : "lock-step";
  if (measured.wall_s) summary["wall_s"] = *measured.wall_s;
  if (measured.ns_per_agent_step) summary["ns_per_agent_step"] = *measured.ns_per_agent_step;
  summary["hearing_s"] =
      measured.neighbour_discovery_s < 0.0 ? Json() : Json(measured.neighbour_discovery_s);
  summary["refused_by_launcher"] = measured.refused_by_launcher;
  summary["plan_excess_m"] = excess.largest_m;
  summary["plans"] = excess.plans;
  summary["plans_with_excess"] = excess.broken;
}

void print_text(const Result<monitor::AuditedRun>& audited, const Measurements& measured,
                const PlansExcess& excess, const std::string& report) {
  std::fputs((audited ? monitor::to_text(audited->audit) : audited.error().message + "\n").c_str(),
             stdout);
  if (measured.wall_s) {
    std::printf("wall time        %.2f s, %.0f ns per agent and step\n", *measured.wall_s,
                *measured.ns_per_agent_step);
  }
  if (excess.broken > 0) {
    std::printf("risk limit       broken by %zu of %zu plans, by up to %.2f m\n", excess.broken,
                excess.plans, excess.largest_m);
  }
  if (!audited) {  // otherwise they are among the reasons
    for (const std::string& text : measured.missing)
      std::printf("missing          %s\n", text.c_str());
  }
  std::printf("mission          %s\nreport           %s\n",
              std::string(to_string(measured.outcome)).c_str(), report.c_str());
}

}  // namespace

// The launcher's part is handed to the audit by the file, or, on a full disk, not at all: then what
// is missing is added here.
Result<ExitCode> summarise(const std::filesystem::path& run_dir, const Measurements& measured,
                           bool json) {
  const std::filesystem::path file = run_dir / shell::kSummaryFile;
  const auto own = shell::write_file(file, own_part(run_dir, measured).dump(2) + "\n");
  auto audited = monitor::audit_run_fully(run_dir);
  if (audited && !own) add_missing(audited->audit, measured.missing);
  if (audited && !own) add_missing(audited->audit, {own.error().message});
  Json summary = audited ? Json::parse(monitor::to_json(audited->audit))
                         : empty_summary(own_part(run_dir, measured), audited.error().message);
  const PlansExcess excess = plans_excess(run_dir);
  complete(summary, measured, excess);
  // A path in the text of an error may be no UTF-8.
  const std::string text = summary.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  const auto written = own ? shell::write_file(file, text) : own;
  const std::string report = write_report(run_dir, audited);
  if (json) {
    std::fputs(text.c_str(), stdout);
  } else {
    print_text(audited, measured, excess, report);
  }
  if (!written) std::fprintf(stderr, "%s\n", written.error().message.c_str());
  const bool complete_and_ok = audited && audited->audit.ok() && written.has_value();
  return exit_code_of(measured.outcome, complete_and_ok);
}

}  // namespace swarm::launcher
