// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/blackbox/blackbox_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "swarm_core/base/assert.hpp"
#include "swarm_core/blackbox/record_codec.hpp"

namespace swarm::blackbox {
namespace {

constexpr std::string_view kMagic = "SWBBOX1\n";
constexpr std::size_t kFrameBytes = 8;
/// A robot at 10 Hz writes 2 MB an hour; beyond this it is no black box.
constexpr std::uintmax_t kMaxFileBytes = 1ULL << 32U;

std::uint32_t crc_of(std::span<const unsigned char> payload) {
  return static_cast<std::uint32_t>(
      ::crc32(0UL, payload.data(), static_cast<uInt>(payload.size())));
}

struct Frame {
  std::uint8_t kind = 0;
  std::size_t size = 0;
  std::uint32_t crc = 0;
};

/// The frame at the front of `bytes`, if it could be one.
std::optional<Frame> frame_at(std::span<const unsigned char> bytes) {
  if (bytes.size() < kFrameBytes) return std::nullopt;
  const Frame frame{
      .kind = bytes[0],
      .size = static_cast<std::size_t>(bytes[2]) | static_cast<std::size_t>(bytes[3]) << 8U,
      .crc = static_cast<std::uint32_t>(bytes[4]) | static_cast<std::uint32_t>(bytes[5]) << 8U |
             static_cast<std::uint32_t>(bytes[6]) << 16U |
             static_cast<std::uint32_t>(bytes[7]) << 24U};
  if (bytes[1] != 0 || !is_plausible(frame.kind, frame.size)) return std::nullopt;
  return frame;
}

/// The whole record at the front of `bytes`, if there is one.
std::optional<Record> record_at(std::span<const unsigned char> bytes, std::size_t& length) {
  const auto frame = frame_at(bytes);
  if (!frame || bytes.size() < kFrameBytes + frame->size) return std::nullopt;
  const auto payload = bytes.subspan(kFrameBytes, frame->size);
  if (crc_of(payload) != frame->crc) return std::nullopt;
  length = kFrameBytes + frame->size;
  return decode(frame->kind, payload);
}

Result<std::vector<unsigned char>> bytes_of(const std::filesystem::path& file) {
  const auto error = [&](std::string_view what) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("{}: {}: {}", file.string(), what, std::strerror(errno)));
  };
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return error("cannot be opened");
  std::vector<unsigned char> bytes;
  std::size_t used = 0;
  while (true) {
    if (used == bytes.size()) bytes.resize(used == 0 ? 1U << 16U : 2 * used);
    const ssize_t n = ::read(fd, bytes.data() + used, bytes.size() - used);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 || used > kMaxFileBytes) {
      if (n >= 0) errno = EFBIG;
      auto failure = error("cannot be read");
      ::close(fd);
      return failure;
    }
    if (n == 0) break;
    used += static_cast<std::size_t>(n);
  }
  ::close(fd);
  bytes.resize(used);
  return bytes;
}

/// Appends the framed record to `out`.
void frame_record(const Record& record, std::vector<unsigned char>& out) {
  const std::size_t frame = out.size();
  out.resize(frame + kFrameBytes);
  const std::uint8_t kind = encode(record, out);
  const auto payload = std::span<const unsigned char>(out).subspan(frame + kFrameBytes);
  const std::size_t size = payload.size();
  const std::uint32_t crc = crc_of(payload);
  out[frame] = kind;
  out[frame + 1] = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    out[frame + 2 + i] = static_cast<unsigned char>(size >> (8U * i));
  }
  for (std::size_t i = 0; i < 4; ++i) {
    out[frame + 4 + i] = static_cast<unsigned char>(crc >> (8U * i));
  }
}

}  // namespace

std::filesystem::path file_of(const std::filesystem::path& run_dir, RobotId robot) {
  return run_dir / "blackbox" / fmt::format("robot-{:05}.bbox", robot.value());
}

Result<Writer> Writer::open(const std::filesystem::path& file, std::uint32_t at_once,
                            std::uint32_t turn) {
  SWARM_ASSERT(turn < at_once);
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (fd < 0) {
    return fail(ErrorCode::kEnvironment, fmt::format("black box {} cannot be opened: {}",
                                                     file.string(), std::strerror(errno)));
  }
  return Writer(fd, at_once, turn);
}

Writer::Writer(Writer&& other) noexcept { *this = std::move(other); }

Writer& Writer::operator=(Writer&& other) noexcept {
  if (this == &other) return *this;
  std::swap(fd_, other.fd_);
  std::swap(at_once_, other.at_once_);
  std::swap(until_written_, other.until_written_);
  std::swap(waiting_, other.waiting_);
  std::swap(dropped_, other.dropped_);
  std::swap(buffer_, other.buffer_);
  return *this;
}

Writer::~Writer() {
  if (fd_ < 0) return;
  write();
  ::close(fd_);
}

void Writer::append(const Record& record) {
  frame_record(record, buffer_);
  ++waiting_;
  if (--until_written_ > 0) return;
  until_written_ = at_once_;
  write();
}

void Writer::write() {
  if (waiting_ == 0) return;
  const std::uint32_t records = std::exchange(waiting_, 0);
  struct stat before {};
  bool written = fd_ >= 0 && ::fstat(fd_, &before) == 0;
  if (written) {
    // The magic goes with the first record that the disk takes, in the same write.
    if (before.st_size == 0) buffer_.insert(buffer_.begin(), kMagic.begin(), kMagic.end());
    ssize_t bytes = -1;
    do {
      bytes = ::write(fd_, buffer_.data(), buffer_.size());
    } while (bytes < 0 && errno == EINTR);
    written = bytes == static_cast<ssize_t>(buffer_.size());
    // Half a record would hide the next one from a simple reader. If this fails too, readers
    // resync.
    if (!written && bytes > 0) [[maybe_unused]]
      const int ignored = ::ftruncate(fd_, before.st_size);
  }
  if (!written) dropped_ += records;
  buffer_.clear();
}

Batch::Batch() : bytes_(kMagic.begin(), kMagic.end()) {}

void Batch::append(const Record& record) { frame_record(record, bytes_); }

Result<void> Batch::write(const std::filesystem::path& file) const {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "wb"),
                                                               &std::fclose);
  if (!stream || std::fwrite(bytes_.data(), 1, bytes_.size(), stream.get()) != bytes_.size() ||
      std::fflush(stream.get()) != 0) {
    return fail(ErrorCode::kEnvironment, fmt::format("black box {} cannot be written: {}",
                                                     file.string(), std::strerror(errno)));
  }
  return {};
}

Result<Damage> read_records(const std::filesystem::path& file,
                            const std::function<void(const Record&)>& take) {
  const auto bytes = bytes_of(file);
  if (!bytes) return tl::unexpected(bytes.error());
  Damage result;
  std::span<const unsigned char> rest(*bytes);
  if (rest.empty()) {
    result.truncated = true;
    return result;
  }
  if (rest.size() < kMagic.size() || std::memcmp(rest.data(), kMagic.data(), kMagic.size()) != 0) {
    return fail(ErrorCode::kBadInput,
                fmt::format("{}: no black box: it does not begin with SWBBOX1", file.string()));
  }
  rest = rest.subspan(kMagic.size());
  bool in_damage = false;
  while (!rest.empty()) {
    std::size_t length = 0;
    if (const auto record = record_at(rest, length)) {
      take(*record);
      rest = rest.subspan(length);
      in_damage = false;
      continue;
    }
    if (!in_damage) {
      const auto frame = frame_at(rest);
      // Whether a cut or a flipped bit ends the file cannot be told when only a piece is left.
      const bool ends_inside =
          rest.size() < kFrameBytes || (frame && rest.size() < kFrameBytes + frame->size);
      result.truncated = ends_inside;
      ++result.damaged;
      in_damage = true;
    }
    // The size of a damaged record is not to be believed: look for the next whole one byte by byte.
    rest = rest.subspan(1);
  }
  if (result.truncated && in_damage) --result.damaged;
  if (!in_damage) result.truncated = false;
  return result;
}

Result<File> read_file(const std::filesystem::path& file) {
  File result;
  const auto damage =
      read_records(file, [&](const Record& record) { result.records.push_back(record); });
  if (!damage) return tl::unexpected(damage.error());
  static_cast<Damage&>(result) = *damage;
  return result;
}

}  // namespace swarm::blackbox
