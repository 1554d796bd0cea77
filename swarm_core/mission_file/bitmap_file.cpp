// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission_file/bitmap_file.hpp"

#include <array>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <png.h>

namespace swarm {
namespace {

using Parsed = tl::expected<GreyImage, std::string>;

tl::unexpected<std::string> refuse(std::string what) {
  return tl::unexpected<std::string>(std::move(what));
}

/// Sizes are checked before pixels are allocated: a header of a few bytes can announce any size.
std::optional<std::string> wrong_size(std::size_t width, std::size_t height) {
  if (width >= 1 && height >= 1 && width <= kMaxBitmapSide && height <= kMaxBitmapSide) {
    return std::nullopt;
  }
  return fmt::format("is {} x {} pixels; must be from 1 x 1 to {} x {}", width, height,
                     kMaxBitmapSide, kMaxBitmapSide);
}

/// Uses libpng's simplified interface, which reports errors in `message` instead of by longjmp, and
/// lets it convert every kind of PNG to 8-bit grey.
Parsed parse_png(const std::string& bytes, std::uint8_t background) {
  png_image image;
  std::memset(&image, 0, sizeof image);
  image.version = PNG_IMAGE_VERSION;
  const auto complaint = [&image] {
    std::string what = fmt::format("is no good PNG ({}); save it again", image.message);
    png_image_free(&image);
    return refuse(std::move(what));
  };
  if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0) return complaint();
  if (auto wrong = wrong_size(image.width, image.height)) {
    png_image_free(&image);
    return refuse(*std::move(wrong));
  }
  image.format = PNG_FORMAT_GRAY;
  GreyImage grey{image.width, image.height, {}};
  grey.levels.resize(grey.width * grey.height);
  // Transparent pixels are composed with this colour.
  const png_color behind{background, background, background};
  if (png_image_finish_read(&image, &behind, grey.levels.data(), 0, nullptr) == 0) {
    return complaint();
  }
  return grey;
}

/// The portable bitmap formats: a magic number, a few decimal numbers with comments between, then
/// pixels, as text or packed.
class PnmReader {
 public:
  explicit PnmReader(std::string_view bytes) : bytes_(bytes) {}

  // The digit after 'P' selects the kind: 1 and 4 are bits, 2 and 5 are greys; 1 and 2 are text.
  Parsed read() {
    const char kind = bytes_[1];
    at_ = 2;
    const bool bits = kind == '1' || kind == '4';
    const auto width = number();
    const auto height = number();
    const auto most = bits ? std::optional<std::size_t>(1) : number();
    if (!width || !height || !most) return refuse("has no good PBM or PGM header; save it again");
    if (auto wrong = wrong_size(*width, *height)) return refuse(*std::move(wrong));
    if (*most < 1 || *most > 255) {
      return refuse(fmt::format("has {} grey levels; must have at most 255", *most));
    }
    GreyImage image{*width, *height, {}};
    image.levels.reserve(image.width * image.height);
    const bool whole = kind == '1'   ? text_bits(image)
                       : kind == '2' ? text_greys(image, *most)
                       : kind == '4' ? packed_bits(image)
                                     : packed_greys(image, *most);
    if (!whole) return refuse("ends before its last pixel or has a wrong one; save it again");
    return image;
  }

 private:
  // The blanks of the specification, whatever the locale.
  static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

  void skip_blanks() {
    for (bool comment = false; at_ < bytes_.size(); ++at_) {
      const char c = bytes_[at_];
      if (comment) {
        comment = c != '\n';
      } else if (c == '#') {
        comment = true;
      } else if (!is_space(c)) {
        return;
      }
    }
  }

  // Nine digits at most: the product of two such numbers still fits 64 bits.
  std::optional<std::size_t> number() {
    skip_blanks();
    std::size_t value = 0;
    const std::size_t first = at_;
    for (; at_ < bytes_.size() && bytes_[at_] >= '0' && bytes_[at_] <= '9'; ++at_) {
      if (at_ - first >= 9) return std::nullopt;
      value = 10 * value + static_cast<std::size_t>(bytes_[at_] - '0');
    }
    if (at_ == first) return std::nullopt;
    return value;
  }

  static std::uint8_t level(std::size_t value, std::size_t most) {
    return static_cast<std::uint8_t>(255 * value / most);
  }

  // In bitmaps 1 is black, in greys 0 is black.
  bool text_bits(GreyImage& image) {
    for (std::size_t i = 0; i < image.width * image.height; ++i) {
      skip_blanks();
      if (at_ >= bytes_.size() || (bytes_[at_] != '0' && bytes_[at_] != '1')) return false;
      image.levels.push_back(bytes_[at_++] == '1' ? 0 : 255);
    }
    return true;
  }

  bool text_greys(GreyImage& image, std::size_t most) {
    for (std::size_t i = 0; i < image.width * image.height; ++i) {
      const auto value = number();
      if (!value || *value > most) return false;
      image.levels.push_back(level(*value, most));
    }
    return true;
  }

  // Rows are padded to whole bytes; the leftmost pixel is the highest bit.
  bool packed_bits(GreyImage& image) {
    ++at_;  // the one blank after the header
    const std::size_t row_bytes = (image.width + 7) / 8;
    if (at_ + row_bytes * image.height > bytes_.size()) return false;
    for (std::size_t y = 0; y < image.height; ++y) {
      for (std::size_t x = 0; x < image.width; ++x) {
        const auto byte = static_cast<unsigned char>(bytes_[at_ + y * row_bytes + x / 8]);
        image.levels.push_back((byte >> (7 - x % 8) & 1U) != 0 ? 0 : 255);
      }
    }
    return true;
  }

  bool packed_greys(GreyImage& image, std::size_t most) {
    ++at_;
    if (at_ + image.width * image.height > bytes_.size()) return false;
    for (std::size_t i = 0; i < image.width * image.height; ++i) {
      const auto value = static_cast<unsigned char>(bytes_[at_ + i]);
      if (value > most) return false;
      image.levels.push_back(level(value, most));
    }
    return true;
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
};

/// Reads in pieces up to the limit: the size that the file system reports may be wrong by then.
tl::expected<std::string, std::string> read_bytes(const std::filesystem::path& file) {
  // A pipe or a device could keep the reader waiting for ever.
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    return refuse("cannot be opened; is it a picture next to the mission file?");
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"),
                                                               &std::fclose);
  if (!stream) return refuse("cannot be opened; may it be read?");
  std::string bytes;
  std::array<char, 16'384> piece{};
  while (const std::size_t read = std::fread(piece.data(), 1, piece.size(), stream.get())) {
    bytes.append(piece.data(), read);
    if (bytes.size() > kMaxBitmapBytes) {
      return refuse(fmt::format("has more than {} bytes; scale it down", kMaxBitmapBytes));
    }
  }
  if (std::ferror(stream.get()) != 0) return refuse("cannot be read; may it be?");
  return bytes;
}

/// By magic number; the file's name does not matter.
Parsed parse(const std::string& bytes, std::uint8_t background) {
  if (bytes.starts_with("\x89PNG")) return parse_png(bytes, background);
  for (const char* magic : {"P1", "P2", "P4", "P5"}) {
    if (bytes.starts_with(magic)) return PnmReader(bytes).read();
  }
  return refuse("is no PNG, PBM or PGM; save it as one of these");
}

}  // namespace

Result<GreyImage> load_bitmap(const std::filesystem::path& file, std::uint8_t background) {
  const auto bytes = read_bytes(file);
  auto image = bytes ? parse(*bytes, background) : Parsed(tl::unexpect, bytes.error());
  if (!image) {
    return fail(ErrorCode::kBadInput, fmt::format("{} {}", file.string(), image.error()));
  }
  return *std::move(image);
}

}  // namespace swarm
