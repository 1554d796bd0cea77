// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "swarm_monitor/audit/audit.hpp"

namespace swarm::monitor {

/// The map of a run: obstacles, start and goal, plan, every robot's path in its goal's colour,
/// contacts.
std::string paths_svg(const AuditedRun& audited);

/// The report of a run as one HTML page that loads nothing: no network, no other file.
std::string report_html(const AuditedRun& audited);

/// Audits a run and writes report.html, paths.svg and paths.png into its directory.
Result<AuditedRun> write_report(const std::filesystem::path& run_dir);
/// The same for a run that was audited already.
Result<void> write_report(const std::filesystem::path& run_dir, const AuditedRun& audited);

}  // namespace swarm::monitor
