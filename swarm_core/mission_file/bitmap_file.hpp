// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "swarm_core/gmm/shape_patches.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm {

/// Largest picture read, either side [pixels], and largest file.
inline constexpr std::size_t kMaxBitmapSide = 4096;
inline constexpr std::size_t kMaxBitmapBytes = 64U << 20U;

/// Reads a picture as greys: PNG of any kind, PBM and PGM (P1, P2, P4, P5; at most 255 levels).
/// Where a PNG is transparent, `background` shows. The message of kBadInput names the file and the
/// remedy. Refuses files that are not regular, too large or truncated. Never throws.
Result<GreyImage> load_bitmap(const std::filesystem::path& file, std::uint8_t background = 255);

}  // namespace swarm
