// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "swarmflow/core/result.hpp"

namespace swarm::monitor {

/// Draws an SVG document into a PNG file, `width_px` wide, on white.
Result<void> write_png(const std::filesystem::path& file, const std::string& svg, int width_px);

}  // namespace swarm::monitor
