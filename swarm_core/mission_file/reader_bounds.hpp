// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

#include "swarmflow/mission/options.hpp"

/// Bounds and values that the readers of mission files share. The keys of the sections and their
/// ranges are in include/swarmflow/mission/sections/.
namespace swarm::reader_bounds {

/// Bound of coordinates and sizes: a larger world is a mistake of units.
inline constexpr double kMaxExtent_m = 1e6;
inline constexpr Range kCoordinate_m = between(-kMaxExtent_m, kMaxExtent_m);  ///< x or y
inline constexpr std::size_t kMaxRobotGroups = 64;      ///< with bodies of their own
inline constexpr std::size_t kMaxComponents = 255;      ///< a robot log names goals by one byte
inline constexpr std::size_t kMaxObstacles = 10'000;    ///< of the world
inline constexpr std::size_t kMaxVertices = 100'000;    ///< of all polygons together
inline constexpr std::size_t kMaxScriptEvents = 1'000;  ///< of the mission's script
inline constexpr std::size_t kMaxNameLength = 64;       ///< of the mission, in bytes
inline constexpr Range kScriptTime_s = between(0.0, 1e6);
inline constexpr Range kDensityCap_per_m2 = between(0, 1e6);  ///< or kAutomatic
inline constexpr Range kLag_s = between(0, 60);               ///< or kAutomatic
inline constexpr Range kShapeTolerance_m2 = positive(1e6);    ///< or kAutomatic
inline constexpr std::string_view kAutomatic = "auto";        ///< chosen by the program

}  // namespace swarm::reader_bounds
