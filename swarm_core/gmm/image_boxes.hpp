// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarm_core/gmm/shape_patches.hpp"
#include "swarmflow/core/box.hpp"

namespace swarm {

/// Number of boxes that is enough for a drawing of 500 × 500 pixels and fits into a mission file.
inline constexpr std::size_t kShapeBoxes = 4096;

/// The shape in a picture as boxes [m] that do not overlap. Pixels that are at least half dark (or
/// bright) form runs in each row, and equal runs of consecutive rows form one box. For a picture
/// that needs more than `boxes_max` boxes, square blocks of pixels take the place of pixels, just
/// large enough. Empty if no pixel is dark enough. O(pixels) for each size of blocks that is tried.
std::vector<Box> image_boxes(const GreyImage& image, const ImageFrame& frame,
                             std::size_t boxes_max = kShapeBoxes);

}  // namespace swarm
