// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/gmm/image_boxes.hpp"

#include <algorithm>

#include "swarm_core/base/assert.hpp"

namespace swarm {
namespace {

// In pixels, y down.
struct Run {
  std::size_t left = 0;
  std::size_t right = 0;
  std::size_t top = 0;
  std::size_t bottom = 0;
};

// A picture in square blocks of `side` pixels, each of which belongs to the shape or does not;
// blocks at the right and lower border may be smaller.
class Blocks {
 public:
  Blocks(const GreyImage& image, bool dark, std::size_t side)
      : image_(image), dark_(dark), side_(side) {}

  // A sweep over the rows of blocks. An open run that the next row repeats with the same left and
  // right ends grows by that row; any other open run is complete. O(pixels + rows · runs²) in the
  // worst case, linear for drawings with few runs in a row.
  std::vector<Run> runs() const {
    std::vector<Run> done;
    std::vector<Run> open;
    for (std::size_t top = 0; top < image_.height; top += side_) {
      std::vector<Run> row = runs_of_row(top);
      for (Run& run : row) {
        const auto above = std::find_if(open.begin(), open.end(), [&](const Run& o) {
          return o.left == run.left && o.right == run.right;
        });
        if (above != open.end()) run.top = above->top;
      }
      for (const Run& o : open) {
        const bool goes_on = std::any_of(row.begin(), row.end(), [&](const Run& run) {
          return o.left == run.left && o.right == run.right;
        });
        if (!goes_on) done.push_back(o);
      }
      open = std::move(row);
    }
    done.insert(done.end(), open.begin(), open.end());
    return done;
  }

 private:
  // Maximal sequences of shape blocks in one row.
  std::vector<Run> runs_of_row(std::size_t top) const {
    std::vector<Run> runs;
    const std::size_t bottom = std::min(top + side_, image_.height);
    for (std::size_t left = 0; left < image_.width; left += side_) {
      if (!is_shape(left, top)) continue;
      const std::size_t right = std::min(left + side_, image_.width);
      if (!runs.empty() && runs.back().right == left) {
        runs.back().right = right;
      } else {
        runs.push_back({left, right, top, bottom});
      }
    }
    return runs;
  }

  // Whether the mean level of a block is at least half of full darkness (or brightness).
  bool is_shape(std::size_t left, std::size_t top) const {
    std::size_t sum = 0;
    std::size_t pixels = 0;
    for (std::size_t y = top; y < std::min(top + side_, image_.height); ++y) {
      for (std::size_t x = left; x < std::min(left + side_, image_.width); ++x) {
        const unsigned level = image_.levels[y * image_.width + x];
        sum += dark_ ? 255U - level : level;
        ++pixels;
      }
    }
    return 2 * sum >= 255 * pixels;
  }

  const GreyImage& image_;
  bool dark_;
  std::size_t side_;
};

}  // namespace

std::vector<Box> image_boxes(const GreyImage& image, const ImageFrame& frame,
                             std::size_t boxes_max) {
  SWARM_ASSERT(boxes_max > 0 && image.levels.size() == image.width * image.height);
  std::vector<Run> runs = Blocks(image, frame.dark, 1).runs();
  // Blocks grow by one pixel until the boxes are few enough; a single block is one box, so this
  // ends.
  for (std::size_t side = 2; runs.size() > boxes_max; ++side) {
    runs = Blocks(image, frame.dark, side).runs();
  }
  std::vector<Box> boxes;
  boxes.reserve(runs.size());
  // Rows count from the top of the picture, the world's y axis points up.
  const auto corner = [&](std::size_t x, std::size_t y) -> Vec2 {
    return frame.origin_m +
           frame.pixel_m * Vec2(static_cast<double>(x), static_cast<double>(image.height - y));
  };
  for (const Run& run : runs) {
    boxes.push_back({corner(run.left, run.bottom), corner(run.right, run.top)});
  }
  return boxes;
}

}  // namespace swarm
