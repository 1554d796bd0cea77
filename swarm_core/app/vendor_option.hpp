// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "swarm_core/mission/vendor.hpp"

namespace swarm::shell {

/// Adds `--dds VENDOR`, for a program whose processes all have one role. \pre `vendor` exists while
/// the command line is parsed
inline void add_vendor_option(CLI::App& app, link::Vendor& vendor, const std::string& description) {
  app.add_option_function<std::string>(
         "--dds", [&vendor](const std::string& name) { vendor = *link::vendor_named(name); },
         description)
      ->check(CLI::IsMember({std::string(to_string(link::Vendor::kFastDds)),
                             std::string(to_string(link::Vendor::kCycloneDds))}));
}

}  // namespace swarm::shell
