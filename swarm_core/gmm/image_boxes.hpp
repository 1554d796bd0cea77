// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarm_core/gmm/shape_patches.hpp"
#include "swarmflow/core/box.hpp"

namespace swarm {

/// Enough for a drawing of 500 × 500 pixels, few enough to write into a mission file.
inline constexpr std::size_t kShapeBoxes = 4096;

/// The shape in a picture as boxes [m] that do not overlap: pixels at least half dark (or bright),
/// runs of them in a row, equal runs of rows below each other made one. A picture that needs more
/// than `boxes_max` is taken in blocks of as many pixels as it takes. Empty where nothing is dark
/// enough. O(pixels) a try.
std::vector<Box> image_boxes(const GreyImage& image, const ImageFrame& frame,
                             std::size_t boxes_max = kShapeBoxes);

}  // namespace swarm
