// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/soak/soak_result.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "swarm_monitor/report/charts.hpp"
#include "swarm_monitor/report/report_page.hpp"

namespace swarm::launcher {
namespace {

using Json = nlohmann::ordered_json;

/// Histograms count in microseconds, reports are in milliseconds.
double to_ms(std::int64_t us) { return 1e-3 * static_cast<double>(us); }

/// A share, 0 where there is nothing to share.
double ratio(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

/// The larger of two losses: at the listener, by sequence numbers, and at the robots, by the drops
/// of the kernel.
double loss_of(const SoakMeasurements& m) {
  const double at_listener = m.received ? ratio(m.received->lost, m.received->sent()) : 0.0;
  return std::max(at_listener, ratio(m.receive_drops, m.states_used + m.receive_drops));
}

/// Quantiles of a histogram in ms; null where nothing was measured.
Json quantiles(const Histogram& histogram) {
  if (histogram.count() == 0) return nullptr;
  return {{"p50", to_ms(histogram.quantile_us(0.5))},
          {"p90", to_ms(histogram.quantile_us(0.9))},
          {"p99", to_ms(histogram.quantile_us(0.99))},
          {"p999", to_ms(histogram.quantile_us(0.999))},
          {"p9999", to_ms(histogram.quantile_us(0.9999))},
          {"max", to_ms(histogram.max_us())}};
}

Json to_json(const Growth& growth) {
  return {{"start", growth.start}, {"end", growth.end}, {"max", growth.max}};
}

Json to_json(const PathLatencies& p) {
  return {{"status_ms", quantiles(p.status)},
          {"command_ms", quantiles(p.command)},
          {"scene_to_plan_ms", quantiles(p.plan)},
          {"heartbeat_gap_ms", quantiles(p.beat)},
          {"commands", p.commands},
          {"scenes", p.scenes},
          {"clock_error_ms", to_ms(p.clock_error_us)}};
}

/// The same for a terminal.
std::string quantiles_text(const Histogram& h) {
  if (h.count() == 0) return "not measured";
  return fmt::format("{:.2f} / {:.2f} / {:.2f} / {:.2f} / {:.2f} / {:.2f} ms",
                     to_ms(h.quantile_us(0.5)), to_ms(h.quantile_us(0.9)),
                     to_ms(h.quantile_us(0.99)), to_ms(h.quantile_us(0.999)),
                     to_ms(h.quantile_us(0.9999)), to_ms(h.max_us()));
}

/// A chart of one quantity; its samples are a second apart.
std::string chart_of(const std::vector<SoakSample>& samples, double SoakSample::*what,
                     const std::string& title, const std::string& caption) {
  monitor::Curve curve{.name = title, .values = {}};
  for (const SoakSample& sample : samples) curve.values.push_back(sample.*what);
  const double top =
      curve.values.empty() ? 1.0 : *std::max_element(curve.values.begin(), curve.values.end());
  return fmt::format("<figure><h2>{}</h2>\n{}<figcaption>{}</figcaption></figure>\n", title,
                     monitor::line_chart(std::array{curve}, 1.0, std::max(1.05 * top, 1e-3), title),
                     caption);
}

/// A path that carried nothing fails its limit: a soak that did not measure it must not pass.
void check(const char* what, const Histogram& latency, double value_ms,
           const std::optional<double>& limit_ms, std::vector<std::string>& found) {
  if (!limit_ms) return;
  if (latency.count() == 0) {
    found.push_back(fmt::format("{}: nothing was measured", what));
  } else if (value_ms > *limit_ms) {
    found.push_back(fmt::format("{} {:.1f} ms > {} ms", what, value_ms, *limit_ms));
  }
}

void complain_of_paths(const SoakMeasurements& m, const SoakCriteria& criteria,
                       std::vector<std::string>& found) {
  const PathLatencies& p = m.paths;
  check("status p99", p.status, to_ms(p.status.quantile_us(0.99)), criteria.max_status_ms, found);
  check("command p99", p.command, to_ms(p.command.quantile_us(0.99)), criteria.max_command_ms,
        found);
  check("scene to plan p99", p.plan, to_ms(p.plan.quantile_us(0.99)), criteria.max_plan_ms, found);
  check("longest gap of heartbeats", p.beat, to_ms(p.beat.max_us()), criteria.max_beat_ms, found);
  check("clock error", p.status, to_ms(p.clock_error_us), criteria.max_clock_error_ms, found);
  const double late_pct = 100.0 * ratio(m.late_ticks, m.ticks);
  if (criteria.max_late_pct && late_pct > *criteria.max_late_pct) {
    found.push_back(fmt::format("{:.3f} % late ticks > {} %", late_pct, *criteria.max_late_pct));
  }
  if (!criteria.is_flat) return;
  constexpr double kFlat_pct = 1.0;
  for (const auto& [what, sample] : {std::pair{"threads", &SoakSample::threads},
                                     std::pair{"open files", &SoakSample::open_files}}) {
    const double grown_pct = growth_of(m.samples, sample).percent();
    if (grown_pct > kFlat_pct) found.push_back(fmt::format("{} grew by {:.1f} %", what, grown_pct));
  }
}

}  // namespace

/// Means over tenths of the samples, since single samples of memory vary.
Growth growth_of(const std::vector<SoakSample>& samples, double SoakSample::*what) {
  if (samples.empty()) return {};
  const std::size_t tenth = std::max<std::size_t>(samples.size() / 10, 1);
  // With fewer than two tenths of samples the second tenth is the last one.
  const std::size_t begin = std::min(tenth, samples.size() - tenth);
  const auto mean = [&](std::size_t from) {
    double sum = 0.0;
    for (std::size_t i = from; i < from + tenth; ++i) sum += samples[i].*what;
    return sum / static_cast<double>(tenth);
  };
  Growth growth{.start = mean(begin), .end = mean(samples.size() - tenth)};
  for (const SoakSample& sample : samples) growth.max = std::max(growth.max, sample.*what);
  return growth;
}

/// An unknown latency fails a latency limit: a soak that did not measure it must not pass.
std::vector<std::string> complaints(const SoakResult& result, const SoakCriteria& criteria) {
  std::vector<std::string> found;
  const SoakMeasurements& m = result.measured;
  if (!result.flown) found.emplace_back("the flight was cut short");
  if (result.collisions > 0) found.push_back(fmt::format("{} contacts", result.collisions));
  if (criteria.max_p99_ms) {
    const double p99_ms = to_ms(m.latency.quantile_us(0.99));
    if (m.latency.count() == 0) {
      found.emplace_back("the latency written → received is not known");
    } else if (p99_ms > *criteria.max_p99_ms) {
      found.push_back(fmt::format("p99 {:.2f} ms > {} ms", p99_ms, *criteria.max_p99_ms));
    }
  }
  if (criteria.max_loss && loss_of(m) > *criteria.max_loss) {
    found.push_back(fmt::format("loss {:.6f} > {}", loss_of(m), *criteria.max_loss));
  }
  complain_of_paths(m, criteria, found);
  const double grown_pct = growth_of(m.samples, &SoakSample::rss_mb).percent();
  if (criteria.max_rss_growth_pct && grown_pct > *criteria.max_rss_growth_pct) {
    found.push_back(
        fmt::format("memory grew by {:.2f} % > {} %", grown_pct, *criteria.max_rss_growth_pct));
  }
  return found;
}

/// The content of soak.json. Values that were not measured are null.
std::string to_json(const SoakResult& result, const std::vector<std::string>& complaints) {
  const SoakMeasurements& m = result.measured;
  const Growth rss = growth_of(m.samples, &SoakSample::rss_mb);
  const auto received = [&](std::uint64_t link::StreamMeter::Counts::*count) {
    return m.received ? Json((*m.received).*count) : Json();
  };
  // The robot with the largest latency; null without a listener.
  Json worst = nullptr;
  if (m.latency.count() > 0) {
    worst = {{"robot", m.worst.robot.value()}, {"max_ms", to_ms(m.worst.latency_us)}};
  }
  const Json json = {{"outcome", complaints.empty() ? "ok" : "criteria_not_met"},
                     {"reasons", complaints},
                     {"processes", result.processes},
                     {"per_process", result.per_process},
                     {"rate_hz", result.rate_hz},
                     {"duration_s", result.duration_s},
                     {"channel", std::string(to_string(result.channel))},
                     {"discovery_s", result.discovery_s < 0.0 ? Json() : Json(result.discovery_s)},
                     {"latency_ms", quantiles(m.latency)},
                     {"use_latency_ms", quantiles(m.use_latency)},
                     {"worst", worst},
                     {"sent", m.received ? Json(m.received->sent()) : Json(m.states_sent)},
                     {"received", received(&link::StreamMeter::Counts::received)},
                     {"lost", received(&link::StreamMeter::Counts::lost)},
                     {"gaps", received(&link::StreamMeter::Counts::gaps)},
                     {"duplicates", received(&link::StreamMeter::Counts::duplicates)},
                     {"reordered", received(&link::StreamMeter::Counts::reordered)},
                     {"used", m.states_used},
                     {"receive_drops", m.receive_drops},
                     {"loss", loss_of(m)},
                     {"deadline_miss_ratio", ratio(m.late_ticks, m.ticks)},
                     {"paths", to_json(m.paths)},
                     {"collisions", result.collisions},
                     {"cpu_s", result.cpu_s},
                     {"rss_mb", to_json(rss)},
                     {"rss_worst_mb", growth_of(m.samples, &SoakSample::rss_max_mb).max},
                     {"rss_growth_pct", rss.percent()},
                     {"threads", to_json(growth_of(m.samples, &SoakSample::threads))},
                     {"open_files", to_json(growth_of(m.samples, &SoakSample::open_files))},
                     {"context_switches_hz", growth_of(m.samples, &SoakSample::switches_hz).end},
                     {"p99_ms_over_time", to_json(growth_of(m.samples, &SoakSample::p99_ms))}};
  return json.dump(2) + "\n";
}

/// The summary for the terminal, which the page shows as well.
std::string to_text(const SoakResult& result, const std::vector<std::string>& complaints) {
  const SoakMeasurements& m = result.measured;
  const Growth rss = growth_of(m.samples, &SoakSample::rss_mb);
  const Growth threads = growth_of(m.samples, &SoakSample::threads);
  const Growth files = growth_of(m.samples, &SoakSample::open_files);
  std::string text =
      fmt::format("{}: {} processes of {} robots for {:.0f} s at {:g} Hz by {}\n",
                  complaints.empty() ? "ok" : "criteria not met", result.processes,
                  result.per_process, result.duration_s, result.rate_hz, to_string(result.channel));
  for (const std::string& reason : complaints) text += fmt::format("  - {}\n", reason);
  text += fmt::format("  discovery        {:.2f} s after the last start\n", result.discovery_s);
  text += "                   p50 / p90 / p99 / p99.9 / p99.99 / max\n";
  text += fmt::format("  to a listener    {}\n", quantiles_text(m.latency));
  text += fmt::format("  to its use       {}\n", quantiles_text(m.use_latency));
  if (m.received) {
    text += fmt::format("  states           {} sent, {} lost, {} twice, {} out of order\n",
                        m.received->sent(), m.received->lost, m.received->duplicates,
                        m.received->reordered);
  }
  text += fmt::format("  at the robots    {} used, {} dropped by the kernel\n", m.states_used,
                      m.receive_drops);
  text += fmt::format("  statuses         {}\n", quantiles_text(m.paths.status));
  text +=
      fmt::format("  {:3} commands     {}\n", m.paths.commands, quantiles_text(m.paths.command));
  text += fmt::format("  {:3} scenes       {}\n", m.paths.scenes, quantiles_text(m.paths.plan));
  text += fmt::format("  heartbeats       {}\n", quantiles_text(m.paths.beat));
  text += fmt::format("  late ticks       {:.4f} %\n", 100.0 * ratio(m.late_ticks, m.ticks));
  text += fmt::format("  contacts         {}\n", result.collisions);
  text += fmt::format("  memory           {:.1f} MB to {:.1f} MB: {:+.2f} %\n", rss.start, rss.end,
                      rss.percent());
  text += fmt::format("  threads, files   {:.0f} to {:.0f}, {:.0f} to {:.0f}\n", threads.start,
                      threads.end, files.start, files.end);
  text += fmt::format("  CPU              {:.0f} s\n", result.cpu_s);
  return text;
}

/// A self-contained page: charts are inline SVG.
std::string to_html(const SoakResult& result, const std::vector<std::string>& complaints) {
  const SoakMeasurements& m = result.measured;
  std::string body = fmt::format(
      "<header><h1>Soak</h1><span class=\"badge {}\">{}</span></header>\n<pre>{}</pre>\n"
      "<div class=\"charts\">\n",
      complaints.empty() ? "ok" : "failed",
      complaints.empty() ? "criteria met" : "criteria not met", to_text(result, complaints));
  body += chart_of(m.samples, &SoakSample::p99_ms, "Latency, p99",
                   "Written to received by a waiting listener, ms, in each second.");
  body += chart_of(m.samples, &SoakSample::cpu_share, "CPU",
                   "Cores in use by all processes of the run, the launcher's own included.");
  body += chart_of(m.samples, &SoakSample::rss_mb, "Memory", "Resident, all agents together, MB.");
  body += chart_of(m.samples, &SoakSample::received_hz, "States", "Per second, at the listener.");
  body += chart_of(m.samples, &SoakSample::switches_hz, "Context switches",
                   "Per second, main threads of all agents.");
  body += chart_of(m.samples, &SoakSample::open_files, "Open files", "All agents together.");
  for (const auto& [name, histogram] :
       {std::pair{"Written to received", &m.latency}, {"Written to used", &m.use_latency}}) {
    body += fmt::format(
        "<figure><h2>{}</h2>\n{}<figcaption>{} states. The clocks of all processes are this "
        "machine's.</figcaption></figure>\n",
        name, monitor::histogram_chart(*histogram), histogram->count());
  }
  body += "</div>\n";
  return monitor::report_page("Soak", body);
}

}  // namespace swarm::launcher
