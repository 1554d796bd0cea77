// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/report/report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_monitor/audit/tracking/tracking_charts.hpp"
#include "swarm_monitor/report/charts.hpp"
#include "swarm_monitor/report/png.hpp"
#include "swarm_monitor/report/report_page.hpp"
#include "swarm_monitor/report/svg.hpp"

namespace swarm::monitor {
namespace {

/// Rows of the event table at most: a page of tens of thousands of rows is slow to open.
constexpr std::size_t kMaxEventRows = 500;

/// Collects text; `add` takes fmt's format strings.
class Page {
 public:
  template <class... Args>
  void add(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

enum class Tone { kPlain, kGood, kBad };

Tone tone_if(bool good) { return good ? Tone::kGood : Tone::kBad; }

/// One number of the overview with its label; the tone colours it as good or bad.
void add_figure(Page& page, std::string_view value, std::string_view label,
                Tone tone = Tone::kPlain) {
  const char* css_class = tone == Tone::kGood ? " good" : tone == Tone::kBad ? " bad" : "";
  page.add("<div class=\"figure{}\"><b>{}</b><span>{}</span></div>\n", css_class, value, label);
}

/// A number with its unit, or a dash where it was not measured.
std::string number(const std::optional<double>& value, int digits, std::string_view unit) {
  return value ? fmt::format("{:.{}f} {}", *value, digits, unit) : "–";
}

/// Name, verdict, time and size of the run, and the reasons if it failed.
void add_header(Page& page, const AuditedRun& audited) {
  const Audit& audit = audited.audit;
  const auto begin = std::chrono::floor<std::chrono::seconds>(audited.run.begin);
  page.add("<header><h1>{}</h1><span class=\"badge {}\">{}</span>",
           escape_xml(audited.run.mission.name), audit.ok() ? "ok" : "failed",
           audit.ok() ? "criteria met" : "criteria not met");
  page.add(
      "<span class=\"soft\">{:%Y-%m-%d %H:%M:%S} UTC · {} robots in {} processes</span></header>\n",
      fmt::gmtime(begin.time_since_epoch().count()), audit.robots, audit.processes);
  if (audit.ok()) return;
  page.add("<ul class=\"reasons\">\n");
  for (const std::string& reason : audit.reasons) page.add("<li>{}</li>\n", escape_xml(reason));
  page.add("</ul>\n");
}

/// The headline numbers of the tracking; its charts follow below.
void add_tracking(Page& page, const Tracking& tracking) {
  if (tracking.w2) {
    add_figure(page, number(tracking.w2->ratio(), 2, "×"), "W2 to the plan / floor of sampling");
  }
  if (tracking.ending.to_goal) {
    add_figure(page, number(tracking.ending.to_goal->ratio(), 2, "×"), "W2 to the goal / floor");
  }
  if (tracking.centre_lag_s)
    add_figure(page, number(tracking.centre_lag_s, 1, "s"), "centre's lag");
  if (const auto& error = tracking.own.error) {
    add_figure(page, number(error->p95_m, 2, "m"), "off the own reference, 95 %");
  }
  if (const auto& density = tracking.density) {
    add_figure(page, number(density->worst_per_m2, 2, "/m²"), "largest density in 2 m discs");
  }
  if (const auto& risk = tracking.risk) {
    add_figure(page, number(risk->worst_m, 2, "m"), "worst CVaR flown");
  }
}

void add_figures(Page& page, const Audit& audit) {
  page.add("<div class=\"figures\">\n");
  add_figure(page, fmt::format("{} / {}", audit.arrived, audit.robots), "robots arrived",
             tone_if(audit.arrived == audit.robots));
  add_figure(page, fmt::format("{}", audit.lost.size()), "robots lost",
             tone_if(audit.lost.empty()));
  add_figure(page, fmt::format("{}", audit.collisions_robot), "pairs that touched",
             tone_if(audit.collisions_robot == 0));
  add_figure(page, fmt::format("{}", audit.collisions_obstacle), "robots that touched obstacles",
             tone_if(audit.collisions_obstacle == 0));
  add_figure(page, number(audit.min_robot_gap_m, 3, "m"), "smallest gap between robots");
  add_figure(page, number(audit.min_obstacle_gap_m, 3, "m"), "smallest gap to an obstacle");
  add_figure(page, number(audit.path_ratio, 4, ""), "mean path / geodesic bound");
  add_figure(page, number(audit.mean_path_m, 2, "m"), "mean path");
  add_figure(page, number(audit.geodesic_bound_m, 2, "m"), "geodesic bound");
  add_figure(page, number(audit.mission_s, 1, "s"), "first motion to last arrival");
  add_figure(page, number(audit.plan_ms, 1, "ms"), "planning");
  add_figure(page, number(audit.discovery_s, 2, "s"), "discovery");
  const auto age = [&](double StateAge::*p) {
    return audit.state_age ? std::optional(*audit.state_age.*p) : std::nullopt;
  };
  add_figure(page, number(age(&StateAge::p50_ms), 1, "ms"), "age of states, median");
  add_figure(page, number(age(&StateAge::p99_ms), 1, "ms"), "age of states, 99 %");
  const auto estimate = [&](double EstimateError::*p) {
    return audit.estimate ? std::optional(*audit.estimate.*p) : std::nullopt;
  };
  add_figure(page, number(estimate(&EstimateError::p99_cm), 1, "cm"),
             "error of estimated neighbours, 99 %");
  add_figure(page, fmt::format("{:.3f} %", 100.0 * audit.deadline_miss_ratio),
             "ticks missed or over 20 ms late");
  add_figure(page, fmt::format("{}", audit.refused_messages), "messages refused");
  add_figure(page, number(audit.cpu_s, 1, "s"), "CPU time of all processes");
  add_figure(page, number(audit.max_rss_mb, 1, "MB"), "memory of the largest process");
  add_tracking(page, audit.tracking);
  if (audit.collisions_fallen > 0) {
    add_figure(page, fmt::format("{}", audit.collisions_fallen), "pairs that touched, one dead",
               Tone::kBad);
  }
  if (audit.outside_bounds > 0) {
    add_figure(page, fmt::format("{}", audit.outside_bounds), "robots that left the world",
               Tone::kBad);
  }
  if (audit.damaged_records > 0) {
    add_figure(page, fmt::format("{}", audit.damaged_records), "damaged records", Tone::kBad);
  }
  page.add("</div>\n");
}

/// Gaps over time and per robot, the tracking figures, and the ages of states.
void add_charts(Page& page, const AuditedRun& audited) {
  const std::array<Curve, 2> curves{{{"between robots", audited.robots.by_window_m},
                                     {"to obstacles", audited.obstacles.by_window_m}}};
  page.add(
      "<div class=\"charts\"><figure><h2>Nearest gap</h2>\n{}<figcaption>Smallest gap of the whole "
      "swarm in each second, surface to surface.</figcaption></figure>\n",
      line_chart(curves, Clearance::kWindow_s, Clearance::kCap_m, "gap, m"));
  const std::array<Curve, 2> gaps{
      {{"to robots", audited.robots.by_robot_m}, {"to obstacles", audited.obstacles.by_robot_m}}};
  page.add(
      "<figure><h2>Gap and clearance</h2>\n{}<figcaption>How near each robot ever came to another "
      "and to an obstacle.</figcaption></figure>\n",
      bar_chart(gaps, Clearance::kCap_m, "smallest gap of a robot, m"));
  page.add("{}", tracking_figures(audited.audit.tracking));
  Histogram age;
  for (const Track& track : audited.run.tracks) age.merge(track.state_age);
  if (const std::string chart = histogram_chart(age); !chart.empty()) {
    page.add(
        "<figure><h2>Age of states</h2>\n{}<figcaption>From a robot's measurement to its use in a "
        "neighbour's controller; {} states.</figcaption></figure>\n",
        chart, age.count());
  }
  page.add("</div>\n");
}

/// Table of the robots that were lost or whose log is damaged, with what is known of the cause.
void add_losses(Page& page, const AuditedRun& audited) {
  std::vector<std::string> rows;
  for (std::size_t i = 0; i < audited.run.tracks.size(); ++i) {
    const Track& track = audited.run.tracks[i];
    if (!audited.audit.by_robot[i].lost && track.damaged == 0 && track.lost == 0) {
      continue;
    }
    std::string why = !track.unreadable.empty() ? escape_xml(track.unreadable)
                      : !track.ended_gracefully ? "its process ended without logging its exit"
                                                : "";
    if (track.damaged > 0) {
      why += fmt::format("{}{} damaged places in its robot log", why.empty() ? "" : "; ",
                         track.damaged);
    }
    if (track.lost > 0) {
      why +=
          fmt::format("{}{} records missing in its robot log", why.empty() ? "" : "; ", track.lost);
    }
    if (!track.notes.empty()) {
      why += fmt::format("; last note: {} {}", escape_xml(track.notes.back().code),
                         escape_xml(track.notes.back().text));
    }
    const std::string last =
        track.points.empty()
            ? "<td></td><td></td>"
            : fmt::format("<td>{:.1f}</td><td>{:.2f}, {:.2f}</td>", track.points.back().time_s,
                          track.points.back().position_m.x(), track.points.back().position_m.y());
    rows.push_back(fmt::format("<tr><td>{}</td>{}<td class=\"text wide\">{}</td></tr>\n",
                               track.robot.value(), last, why));
  }
  if (rows.empty()) return;
  page.add(
      "<h2>Lost, and why</h2>\n<div class=\"scroll\"><table class=\"sortable\"><thead><tr>"
      "<th>robot</th><th>last step at, s</th><th>at, m</th><th class=\"text\">why</th></tr></thead>"
      "<tbody>\n");
  for (const std::string& row : rows) page.add("{}", row);
  page.add("</tbody></table></div>\n");
}

/// A gap in the table of robots; capped gaps sort by the cap.
std::string gap_cell(double gap_m) {
  if (gap_m >= Clearance::kCap_m) {
    return fmt::format("<td data-key=\"{0}\">≥ {0:.0f}</td>", Clearance::kCap_m);
  }
  return fmt::format("<td{}>{:.3f}</td>", gap_m <= 0.0 ? " class=\"bad-text\"" : "", gap_m);
}

/// One row per robot. Columns sort in the browser by `data-key` where the text is not a number.
void add_robots(Page& page, const AuditedRun& audited) {
  page.add(
      "<h2>Robots</h2>\n<div class=\"scroll\"><table class=\"sortable\"><thead><tr><th>robot</th>"
      "<th class=\"text\">end</th><th>goal</th><th>path, m</th><th>arrived at, s</th>"
      "<th>gap to robots, m</th><th>gap to obstacles, m</th><th>late steps, %</th>"
      "<th>refused</th><th>processes</th></tr></thead><tbody>\n");
  for (std::size_t i = 0; i < audited.audit.by_robot.size(); ++i) {
    const RobotAudit& robot = audited.audit.by_robot[i];
    const Track& track = audited.run.tracks[i];
    const char* end = robot.arrived ? "arrived" : robot.lost ? "lost" : "not arrived";
    page.add("<tr><td>{}</td><td class=\"text{}\">{}</td>", robot.robot.value(),
             robot.arrived ? "" : " bad-text", end);
    if (robot.goal) {
      page.add("<td>{}</td>", *robot.goal);
    } else {
      page.add("<td></td>");
    }
    page.add("<td>{:.2f}</td>", robot.path_m);
    page.add("<td>{}</td>", robot.arrived_at_s ? fmt::format("{:.1f}", *robot.arrived_at_s) : "");
    page.add("{}{}", gap_cell(audited.robots.by_robot_m[i]),
             gap_cell(audited.obstacles.by_robot_m[i]));
    const double steps = static_cast<double>(std::max<std::size_t>(1, track.points.size()));
    page.add("<td>{:.2f}</td><td>{}</td><td>{}</td></tr>\n",
             100.0 * static_cast<double>(track.late_ticks) / steps, track.refused,
             track.processes.size());
  }
  page.add("</tbody></table></div>\n");
}

/// The events of the run from the event log and the robots' notes. Routine notes (mode, plan, exit)
/// are left out.
std::vector<RunEvent> events_of(const RecordedRun& run) {
  std::vector<RunEvent> events = run.events;
  for (const Track& track : run.tracks) {
    const std::string source = fmt::format("robot-{}", track.robot.value());
    if (!track.unreadable.empty()) {
      events.push_back({.source = source,
                        .severity = "error",
                        .code = "no-robot-log",
                        .text = track.unreadable});
    }
    for (const robot_log::Note& note : track.notes) {
      if (note.code == "mode" || note.code == "plan" || note.code == "exit") continue;
      events.push_back({.time_s = to_seconds(note.stamp - run.begin),
                        .source = source,
                        .severity = "note",
                        .code = note.code,
                        .text = note.text});
    }
  }
  std::stable_sort(events.begin(), events.end(),
                   [](const RunEvent& a, const RunEvent& b) { return a.time_s < b.time_s; });
  return events;
}

void add_events(Page& page, const RecordedRun& run) {
  const std::vector<RunEvent> events = events_of(run);
  if (events.empty()) return;
  page.add(
      "<h2>Events</h2>\n<div class=\"scroll\"><table class=\"sortable\"><thead><tr><th>time, s</th>"
      "<th class=\"text\">source</th><th class=\"text\">severity</th><th class=\"text\">code</th>"
      "<th class=\"text\">what</th></tr></thead><tbody>\n");
  const std::size_t shown = std::min(events.size(), kMaxEventRows);
  for (std::size_t i = 0; i < shown; ++i) {
    const RunEvent& event = events[i];
    page.add(
        "<tr><td>{:.2f}</td><td class=\"text\">{}</td><td class=\"text{}\">{}</td>"
        "<td class=\"text\">{}</td><td class=\"text wide\">{}</td></tr>\n",
        event.time_s, escape_xml(event.source), event.severity == "error" ? " bad-text" : "",
        escape_xml(event.severity), escape_xml(event.code), escape_xml(event.text));
  }
  page.add("</tbody></table></div>\n");
  if (shown < events.size()) {
    page.add("<p class=\"soft\">and {} more</p>\n", events.size() - shown);
  }
}

}  // namespace

std::string paths_svg(const AuditedRun& audited) {
  const RecordedRun& run = audited.run;
  // Obstacles as they stood at the end of the run.
  MapSvg map(world_phases(run.mission.world, run.scenes).back().world);
  map.add_start(run.mission.start);
  map.add_goal(run.goal());
  if (const FlowPlan* plan = run.first_plan()) map.add_plan(*plan);
  for (std::size_t i = 0; i < run.tracks.size(); ++i) {
    std::vector<Vec2> points;
    for (const TrackPoint& point : run.tracks[i].points) points.push_back(point.position_m);
    map.add_track(points, audited.audit.by_robot[i].goal, audited.audit.by_robot[i].lost);
  }
  for (const Approach& contact : audited.robots.contacts) {
    map.add_contact(contact.at_m,
                    fmt::format("robots {} and {} touched at {:.1f} s: gap {:.3f} m", contact.robot,
                                contact.other, contact.time_s, contact.gap_m));
  }
  for (const Approach& contact : audited.robots.fallen_contacts) {
    map.add_contact(contact.at_m,
                    fmt::format("robots {} and {} touched at {:.1f} s, one dead: gap {:.3f} m",
                                contact.robot, contact.other, contact.time_s, contact.gap_m));
  }
  for (const Approach& contact : audited.obstacles.contacts) {
    map.add_contact(contact.at_m,
                    fmt::format("robot {} touched obstacle {} at {:.1f} s: gap {:.3f} m",
                                contact.robot, contact.other, contact.time_s, contact.gap_m));
  }
  return map.finish();
}

/// One self-contained page: style, script and SVG are inline.
std::string report_html(const AuditedRun& audited) {
  Page page;
  add_header(page, audited);
  add_figures(page, audited.audit);
  page.add(
      "<h2>Paths</h2>\n<figure>{}<figcaption>Each robot's path in the colour of its goal; ellipses "
      "hold 99 % and one σ of start and goal; the plan lies faintly behind; red rings are "
      "contacts.</figcaption></figure>\n",
      paths_svg(audited));
  add_charts(page, audited);
  add_losses(page, audited);
  add_robots(page, audited);
  add_events(page, audited.run);
  page.add("<p class=\"soft\">Computed from the robots' robot logs by swarm_monitor " SWARM_VERSION
           "; planning, discovery, CPU and memory as measured by the launcher.</p>\n");
  return report_page(audited.run.mission.name, page.take());
}

Result<AuditedRun> write_report(const std::filesystem::path& run_dir) {
  auto audited = audit_run_fully(run_dir);
  if (!audited) return audited;
  if (auto written = write_report(run_dir, *audited); !written) {
    return tl::unexpected(written.error());
  }
  return audited;
}

Result<void> write_report(const std::filesystem::path& run_dir, const AuditedRun& audited) {
  const std::string paths = paths_svg(audited);
  if (auto written = shell::write_file(run_dir / "paths.svg", paths); !written) return written;
  constexpr int kImageWidth_px = 1600;
  if (auto written = write_png(run_dir / "paths.png", paths, kImageWidth_px); !written) {
    return written;
  }
  return shell::write_file(run_dir / "report.html", report_html(audited));
}

}  // namespace swarm::monitor
