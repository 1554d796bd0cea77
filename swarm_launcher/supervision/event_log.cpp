// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/supervision/event_log.hpp"

#include <fstream>
#include <memory>

#include <nlohmann/json.hpp>

#include "swarm_link/event_names.hpp"

namespace swarm::launcher {

LineSink append_to_file(const std::filesystem::path& file) {
  auto out = std::make_shared<std::ofstream>(file, std::ios::app);
  return [out](std::string_view line) { *out << line << std::flush; };
}

void EventLog::write(UtcTime at, const std::string& source, link::Severity severity,
                     const std::string& code, const std::string& text) {
  const nlohmann::ordered_json line = {{"utc_ns", at.time_since_epoch().count()},
                                       {"source", source},
                                       {"severity", link::to_string(severity)},
                                       {"code", code},
                                       {"text", text}};
  // Text from the bus may contain any bytes: invalid UTF-8 is replaced.
  sink_(line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

// By the sender's stamp, so lines of different sources need not be sorted by time.
void EventLog::write(const link::EventMessage& event) {
  write(UtcTime(Duration(event.stamp_utc_ns)), link::source_name(event.source), event.severity,
        event.code, event.text);
}

}  // namespace swarm::launcher
