// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/summary.hpp"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "swarm_core/shell/run_directory.hpp"
#include "swarm_monitor/audit.hpp"
#include "swarm_monitor/report.hpp"

namespace swarm::launcher {
namespace {

using Json = nlohmann::ordered_json;

/// The planner writes its own times; a planner that never planned leaves none.
Json plan_ms(const std::filesystem::path& run_dir) {
  const auto text = shell::read_file(run_dir / shell::kPlanStatsFile, 1U << 16U);
  if (!text) return nullptr;
  const Json stats = Json::parse(*text, nullptr, false);
  return stats.is_object() ? stats.value("total_ms", Json()) : Json();
}

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

}  // namespace

Result<ExitCode> summarise(const std::filesystem::path& run_dir, const Measurements& measured,
                           bool json) {
  const Json own = {
      {"plan_ms", plan_ms(run_dir)},
      {"discovery_s", measured.discovery_s < 0.0 ? Json() : Json(measured.discovery_s)},
      {"cpu_s", measured.cpu_s},
      {"max_rss_mb", measured.max_rss_mb}};
  if (auto w = shell::write_file(run_dir / shell::kSummaryFile, own.dump(2) + "\n"); !w) {
    return tl::unexpected(w.error());
  }
  const auto audit = monitor::audit_run(run_dir);  // carries over what was just written
  if (!audit) return tl::unexpected(audit.error());

  Json summary = Json::parse(monitor::to_json(*audit));
  if (measured.outcome != Outcome::kCompleted) summary["outcome"] = to_string(measured.outcome);
  summary["refused_by_launcher"] = measured.refused_by_launcher;
  const std::string text = summary.dump(2) + "\n";
  if (auto w = shell::write_file(run_dir / shell::kSummaryFile, text); !w) {
    return tl::unexpected(w.error());
  }
  if (auto reported = monitor::write_report(run_dir); !reported) {
    std::fprintf(stderr, "no report: %s\n", reported.error().message.c_str());
  }
  if (json) {
    std::fputs(text.c_str(), stdout);
  } else {
    std::fputs(monitor::to_text(*audit).c_str(), stdout);
    std::printf("%s  report: %s\n", std::string(to_string(measured.outcome)).c_str(),
                (run_dir / "report.html").c_str());
  }
  return exit_code_of(measured.outcome, audit->ok());
}

}  // namespace swarm::launcher
