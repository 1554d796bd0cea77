// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/report/png.hpp"

#include <array>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <unistd.h>

#include "swarm_monitor/report/svg.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::monitor {
namespace {

/// A file in the temporary folder that goes with the test.
class PngFile : public testing::Test {
 protected:
  ~PngFile() override { std::filesystem::remove(file_); }

  std::string bytes() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// A big-endian number of the image's header.
  static std::uint32_t number_at(const std::string& png, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      value = value << 8U | static_cast<unsigned char>(png.at(at + k));
    }
    return value;
  }

  std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("png_test_" + std::to_string(::getpid()) + ".png");
};

/// An SVG document of this size with something inside.
std::string svg_of(int width, int height, const std::string& body = {}) {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + std::to_string(width) + " " +
         std::to_string(height) + "\">" + body + "</svg>";
}

TEST_F(PngFile, HasTheWidthAskedForAndTheShapeOfTheDrawing) {
  for (const auto& [width, height, expected] :
       {std::array{100, 50, 32}, {50, 100, 128}, {3, 1, 21}, {1, 1, 64}}) {
    ASSERT_TRUE(write_png(file_, svg_of(width, height), 64));

    const std::string png = bytes();
    EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
    EXPECT_EQ(number_at(png, 16), 64U);
    EXPECT_EQ(number_at(png, 20), static_cast<std::uint32_t>(expected)) << width << " " << height;
  }
}

TEST_F(PngFile, ReportsWhatCannotBeDrawn) {
  for (const std::string& bad :
       {std::string(), std::string("no svg"), std::string("<svg"), svg_of(0, 10),
        std::string("<svg xmlns=\"http://www.w3.org/2000/svg\"/>")}) {
    const auto written = write_png(file_, bad, 64);
    ASSERT_FALSE(written) << bad;
    EXPECT_EQ(written.error().code, ErrorCode::kEnvironment);
    EXPECT_EQ(written.error().message.find(file_.string() + ": "), 0U) << written.error().message;
    EXPECT_FALSE(std::filesystem::exists(file_)) << "no half of an image";
  }
}

TEST_F(PngFile, ReportsAFolderThatIsNotThere) {
  const auto file = file_.parent_path() / "png_test_no_folder" / "a.png";
  const auto written = write_png(file, svg_of(10, 10), 64);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().message.find(file.string() + ": "), 0U) << written.error().message;
}

/// The bytes of a code point, also of one that no text may hold.
std::string utf8(std::uint32_t code) {
  const auto byte = [](std::uint32_t value) { return static_cast<char>(value); };
  if (code < 0x80) return {byte(code)};
  if (code < 0x800) return {byte(0xC0 | code >> 6U), byte(0x80 | (code & 0x3FU))};
  if (code < 0x10000) {
    return {byte(0xE0 | code >> 12U), byte(0x80 | (code >> 6U & 0x3FU)),
            byte(0x80 | (code & 0x3FU))};
  }
  return {byte(0xF0 | code >> 18U), byte(0x80 | (code >> 12U & 0x3FU)),
          byte(0x80 | (code >> 6U & 0x3FU)), byte(0x80 | (code & 0x3FU))};
}

// The oracle is the XML reader behind write_png(): it refuses a document with a character that XML
// does not allow.
TEST_F(PngFile, CanBeDrawnWithAnyEscapedText) {
  std::vector<std::string> texts;
  for (const std::uint32_t edge :
       {0x00U, 0x7FU, 0x9FU, 0x7FFU, 0x800U, 0xD7FFU, 0xD800U, 0xDFFFU, 0xE000U, 0xFDD0U, 0xFFFDU,
        0xFFFEU, 0xFFFFU, 0x10000U, 0x1FFFEU, 0x10FFFFU, 0x110000U}) {
    texts.push_back("a" + utf8(edge) + "b");
  }
  for (std::uint32_t code = 0; code < 0x20; ++code) texts.push_back(utf8(code));
  Rng rng(17);
  for (int round = 0; round < 300; ++round) {
    std::string text;
    for (std::size_t k = rng() % 20; k > 0; --k) text += static_cast<char>(rng() & 0xFFU);
    texts.push_back(text);
  }

  for (const std::string& text : texts) {
    const std::string escaped = escape_xml(text);
    const std::string body =
        "<text fill=\"" + escaped + "\">" + escaped + "</text><title>" + escaped + "</title>";
    EXPECT_TRUE(write_png(file_, svg_of(4, 4, body), 4)) << testing::PrintToString(text);
  }
}

}  // namespace
}  // namespace swarm::monitor
