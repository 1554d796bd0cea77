// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission_file/bitmap_file.hpp"

#include <array>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

namespace swarm {
namespace {

using std::string_literals::operator""s;

// 3 x 2 greys: 0 85 170 / 255 128 1.
constexpr std::array<unsigned char, 73> kGreyPng{
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44,
    0x52, 0x00, 0x00, 0x00, 0x03, 0x00, 0x00, 0x00, 0x02, 0x08, 0x00, 0x00, 0x00, 0x00, 0xb8,
    0x1f, 0x39, 0xc6, 0x00, 0x00, 0x00, 0x10, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x60,
    0x08, 0x5d, 0xc5, 0xf0, 0xbf, 0x81, 0x11, 0x00, 0x09, 0x56, 0x02, 0x80, 0x61, 0xd6, 0xf7,
    0xfc, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
// 2 x 1 black with alpha: a transparent pixel and an opaque one.
constexpr std::array<unsigned char, 70> kAlphaPng{
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48,
    0x44, 0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x04, 0x00, 0x00,
    0x00, 0x5e, 0x2b, 0xb7, 0x01, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x44, 0x41, 0x54, 0x78,
    0xda, 0x63, 0x60, 0x60, 0x60, 0xf8, 0x0f, 0x00, 0x01, 0x04, 0x01, 0x00, 0x80, 0xbb,
    0xd1, 0x5b, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
// Its header announces 5000 x 10 pixels.
constexpr std::array<unsigned char, 66> kWidePng{
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48,
    0x44, 0x52, 0x00, 0x00, 0x13, 0x88, 0x00, 0x00, 0x00, 0x0a, 0x08, 0x00, 0x00, 0x00,
    0x00, 0x7d, 0xbd, 0xeb, 0x97, 0x00, 0x00, 0x00, 0x09, 0x49, 0x44, 0x41, 0x54, 0x78,
    0x9c, 0x63, 0x00, 0x00, 0x00, 0x01, 0x00, 0x01, 0x5e, 0xff, 0x7d, 0xf9, 0x00, 0x00,
    0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

std::string text_of(std::span<const unsigned char> bytes) { return {bytes.begin(), bytes.end()}; }

class BitmapFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("bitmap-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Result<GreyImage> load(const std::string& bytes, std::uint8_t background = 255) {
    std::ofstream(folder_ / "picture", std::ios::binary) << bytes;
    return load_bitmap(folder_ / "picture", background);
  }

  void expect_refused(const std::string& bytes, const std::string& why) {
    const auto image = load(bytes);
    ASSERT_FALSE(image.has_value()) << why;
    EXPECT_EQ(image.error().code, ErrorCode::kBadInput);
    EXPECT_NE(image.error().message.find(why), std::string::npos) << image.error().message;
    EXPECT_NE(image.error().message.find((folder_ / "picture").string()), std::string::npos);
  }

  std::filesystem::path folder_;
};

using Levels = std::vector<std::uint8_t>;

TEST_F(BitmapFile, ReadsGreyPng) {
  const auto image = load(text_of(kGreyPng));

  ASSERT_TRUE(image.has_value()) << image.error().message;
  EXPECT_EQ(image->width, 3U);
  EXPECT_EQ(image->height, 2U);
  EXPECT_EQ(image->levels, (Levels{0, 85, 170, 255, 128, 1}));
}

TEST_F(BitmapFile, ShowsTheBackgroundThroughTransparentPixels) {
  const auto on_white = load(text_of(kAlphaPng), 255);
  const auto on_black = load(text_of(kAlphaPng), 0);

  ASSERT_TRUE(on_white.has_value() && on_black.has_value());
  EXPECT_EQ(on_white->levels, (Levels{255, 0}));
  EXPECT_EQ(on_black->levels, (Levels{0, 0}));
}

TEST_F(BitmapFile, ReadsPortableBitmaps) {
  const std::vector<std::pair<std::string, Levels>> cases{
      {"P1 # bits\n3 2\n1 0 1\n0 1 0\n", {0, 255, 0, 255, 0, 255}},
      {"P1 3 2 101010", {0, 255, 0, 255, 0, 255}},
      {"P2\n# made by hand\n3 2 # size\n5\n0 1 2 3 4 5", {0, 51, 102, 153, 204, 255}},
      {"P5 3 2 255\n" + std::string("\x00\x01\x80\xff#\n", 6), {0, 1, 128, 255, 35, 10}},
      {"P4 3 2 \xa0\x40", {0, 255, 0, 255, 0, 255}},
      {"P4\n9 1\n" + std::string("\x00\x80", 2), {255, 255, 255, 255, 255, 255, 255, 255, 0}},
  };
  for (const auto& [bytes, levels] : cases) {
    const auto image = load(bytes);

    ASSERT_TRUE(image.has_value()) << image.error().message;
    EXPECT_EQ(image->levels, levels) << bytes;
    EXPECT_EQ(image->width * image->height, levels.size());
  }
}

TEST_F(BitmapFile, RefusesWhatIsNoImage) {
  expect_refused("", "is no PNG, PBM or PGM");
  expect_refused("GIF89a", "is no PNG, PBM or PGM");
  expect_refused("P5", "header");
  expect_refused("P5 3 x", "header");
  expect_refused("P5 9999999999 1 255 ", "header");
  expect_refused("P5 0 1 255 ", "must be from 1 x 1 to 4096 x 4096");
  expect_refused("P5 5000 1 255 ", "is 5000 x 1 pixels");
  expect_refused("P5 2 2 65535\n12345678", "at most 255");
  expect_refused("P5 2 2 0\n1234", "at most 255");
  expect_refused("P5 2 2 100\n\xff\xff\xff\xff", "wrong one");
  expect_refused("P2 2 1 7 3 8", "wrong one");
  expect_refused("P1 2 1 0 2", "wrong one");
  expect_refused(text_of(kWidePng), "is 5000 x 10 pixels");
}

TEST_F(BitmapFile, RefusesImagesCutShortAnywhere) {
  const std::vector<std::string> pictures{text_of(kGreyPng), "P1 3 2 101010",
                                          "P2 3 2 5 0 1 2 3 4 5", "P5 3 2 255 abcdef",
                                          "P4 3 2 \xa0\x40"};
  for (const std::string& whole : pictures) {
    // The end chunk of a PNG, 12 bytes, holds no pixel.
    const std::size_t needed = whole.starts_with('P') ? whole.size() : whole.size() - 12;
    for (std::size_t length = 0; length < needed; ++length) {
      EXPECT_FALSE(load(whole.substr(0, length)).has_value()) << whole << " cut to " << length;
    }
  }
}

TEST_F(BitmapFile, SurvivesAnyChangedByte) {
  for (const std::string& whole : {text_of(kGreyPng), text_of(kAlphaPng), "P2 3 2 5 0 1 2 3 4 5"s,
                                   "P4 3 2 \xa0\x40"s, "P5 3 2 255 abcdef"s}) {
    for (std::size_t i = 0; i < whole.size(); ++i) {
      for (const int flip : {0x01, 0x80, 0xff}) {
        std::string changed = whole;
        changed[i] = static_cast<char>(changed[i] ^ flip);

        const auto image = load(changed);

        if (!image) continue;
        EXPECT_EQ(image->levels.size(), image->width * image->height);
      }
    }
  }
}

TEST_F(BitmapFile, RefusesWhatIsNoFile) {
  EXPECT_FALSE(load_bitmap(folder_).has_value());
  EXPECT_FALSE(load_bitmap(folder_ / "nothing").has_value());
  // No process writes into this pipe, so opening it would block for ever.
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_FALSE(load_bitmap(folder_ / "pipe").has_value());
}

}  // namespace
}  // namespace swarm
