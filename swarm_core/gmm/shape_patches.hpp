// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "swarm_core/gmm/fit_mixture.hpp"
#include "swarmflow/core/polygon.hpp"

namespace swarm {

/// Number of patches that is enough for a good fit and keeps the fit below a second.
inline constexpr std::size_t kShapePatches = 1024;

/// Cuts a polygon along a square grid of about `cells_max` cells over its box. A patch is the
/// polygon's part of one cell: weight = area [m²], centre = centroid, spread = its own covariance,
/// all exact, so together they have the polygon's area, centroid and covariance, however thin it
/// is. O(convex parts · (rows + cells touched)).
std::vector<Patch> polygon_patches(const Polygon& polygon, std::size_t cells_max = kShapePatches);

/// A grey picture: 0 is black, 255 is white; rows from the top down.
struct GreyImage {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<std::uint8_t> levels;  ///< row-major [height × width]
};

/// Where a picture lies in the world, whose y axis points up.
struct ImageFrame {
  Vec2 origin_m = Vec2::Zero();  ///< lower left corner of the lower left pixel
  double pixel_m = 1.0;          ///< side of a pixel
  bool dark = true;              ///< the dark pixels are the shape; false: the bright ones
};

/// Patches of a picture, in square blocks of pixels just large enough to need at most `blocks_max`:
/// weight = darkness (or brightness) summed over the block, in pixels; centre and spread exact with
/// every pixel a uniform square. Empty for a picture without shape.
std::vector<Patch> image_patches(const GreyImage& image, const ImageFrame& frame,
                                 std::size_t blocks_max = kShapePatches);

}  // namespace swarm
