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
  if (event.code != shell::kRecordsLost || losses_.size() == kMostLosses) return;
  losses_.push_back(link::source_name(event.source) + ": " + event.text);
}

}  // namespace swarm::launcher
