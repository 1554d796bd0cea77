// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/gmm/image_boxes.hpp"

#include <gtest/gtest.h>

namespace swarm {
namespace {

// Left: a column of dark pixels two rows high; right: a foot below it; and a faint pixel.
const GreyImage kImage{4,
                       3,
                       {0, 255, 255, 255,  //
                        0, 255, 200, 255,  //
                        0, 0, 0, 255}};

TEST(ImageBoxes, JoinPixelsOfARowAndEqualRows) {
  const auto boxes = image_boxes(kImage, {.origin_m = {10, 20}, .pixel_m = 2.0});

  ASSERT_EQ(boxes.size(), 2U);
  EXPECT_EQ(boxes[0].min_m, Vec2(10, 22));
  EXPECT_EQ(boxes[0].max_m, Vec2(12, 26));
  EXPECT_EQ(boxes[1].min_m, Vec2(10, 20));
  EXPECT_EQ(boxes[1].max_m, Vec2(16, 22));
}

TEST(ImageBoxes, TakeBlocksWhereThereWouldBeTooMany) {
  GreyImage checkers{64, 64, {}};
  for (std::size_t i = 0; i < 64 * 64; ++i) {
    const bool dark = (i / 64 / 4 + i % 64 / 4) % 2 == 0 && i % 3 != 0;
    checkers.levels.push_back(dark ? 0 : 255);
  }

  const auto boxes = image_boxes(checkers, {}, 200);

  EXPECT_LE(boxes.size(), 200U);
  EXPECT_GE(boxes.size(), 100U);
}

TEST(ImageBoxes, NoneInAImageWithoutShape) {
  EXPECT_TRUE(image_boxes({2, 1, {255, 200}}, {}).empty());
}

}  // namespace
}  // namespace swarm
