// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/flight_log.hpp"

#include <cstddef>

#include "swarm_core/app/file_watch.hpp"
#include "swarm_link/event_names.hpp"

namespace swarm::launcher {
namespace {

constexpr std::size_t kMostLosses = 100;

}  // namespace

void FlightLog::note(UtcTime now, link::Severity severity, const std::string& code,
                     const std::string& text) {
  file_.write(now, "launcher", severity, code, text);
  relay_.write({.severity = severity,
                .source = link::kLauncherSource,
                .stamp_utc_ns = now.time_since_epoch().count(),
                .code = code,
                .text = text});
}

void FlightLog::log(UtcTime now, const LogEvent& event) {
  note(now, event.warning ? link::Severity::kWarning : link::Severity::kInfo, event.code,
       event.text);
  if (event.warning) display_.print(event.text);
}

void FlightLog::forward(const link::EventMessage& event) {
  file_.write(event);
  relay_.write(event);
  if (event.code == shell::kDiskFails) failing_.insert(event.source);
  if (event.code == shell::kDiskWorks) failing_.erase(event.source);
  if (event.code != shell::kRecordsLost) return;
  add_loss(link::source_name(event.source) + ": " + event.text);
}

void FlightLog::on_killed(std::uint32_t first_source, std::uint32_t sources) {
  // The planner's number is the largest there is.
  const auto is_its = [&](std::uint32_t source) { return source - first_source < sources; };
  for (const std::uint32_t source : failing_) {
    if (!is_its(source)) continue;
    add_loss(link::source_name(source) +
             ": its process was killed while it could not write its files");
  }
  std::erase_if(failing_, is_its);
}

void FlightLog::add_loss(const std::string& what) {
  if (losses_.size() < kMostLosses) losses_.push_back(what);
}

}  // namespace swarm::launcher
