// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/robot_log/robot_log_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "swarm_core/base/assert.hpp"
#include "swarm_core/robot_log/idl_text.hpp"
#include "swarm_core/robot_log/record_codec.hpp"

namespace swarm::robot_log {
namespace {

/// The first bytes of every robot log: magic, header, and schema and channel of each kind of
/// record.
const mcap::Bytes& preamble() {
  static const mcap::Bytes kPreamble = [] {
    mcap::Bytes out(mcap::kMagic.begin(), mcap::kMagic.end());
    mcap::append_header(out, "swarmflow " SWARM_VERSION);
    for (std::size_t i = 0; i < kinds().size(); ++i) {
      const Kind& kind = kinds()[i];
      mcap::append_schema(out, {.id = static_cast<std::uint16_t>(i + 1),
                                .name = std::string(kind.type),
                                .encoding = "omgidl",
                                .data = mcap::blackbox_idl(kind.structs)});
      mcap::append_channel(out, {.id = static_cast<std::uint16_t>(i),
                                 .schema = static_cast<std::uint16_t>(i + 1),
                                 .topic = std::string(kind.topic),
                                 .encoding = "cdr"});
    }
    return out;
  }();
  return kPreamble;
}

/// Removes the end that an earlier incarnation of the robot's process wrote when it finished, so
/// that this one can append to the file.
bool remove_end(int fd) {
  const mcap::Bytes& end = mcap::plain_end();
  struct stat status {};
  if (::fstat(fd, &status) != 0 || !S_ISREG(status.st_mode)) return true;
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size < end.size()) return true;
  mcap::Bytes last(end.size());
  const auto begin = static_cast<off_t>(size - end.size());
  if (::pread(fd, last.data(), last.size(), begin) != static_cast<ssize_t>(last.size()) ||
      last != end) {
    return true;
  }
  return ::ftruncate(fd, begin) == 0;
}

/// By topic and not by channel number, which differs in recordings of several robots.
std::optional<std::size_t> kind_of(const std::string& topic) {
  for (std::size_t i = 0; i < kinds().size(); ++i) {
    if (kinds()[i].topic == topic) return i;
  }
  return std::nullopt;
}

}  // namespace

std::filesystem::path file_of(const std::filesystem::path& run_dir, RobotId robot) {
  return run_dir / "blackbox" / fmt::format("robot-{:05}.mcap", robot.value());
}

RecordEncoder::RecordEncoder() = default;

/// The header is the first record; the records after it are encoded with its robot id.
void RecordEncoder::add(const Record& record) {
  if (const auto* header = std::get_if<Header>(&record)) robot_ = header->robot;
  encode(robot_, record, message_);
  const std::int64_t stamp_ns = stamp_of(record).time_since_epoch().count();
  chunk_.add({.channel = static_cast<std::uint16_t>(record.index()),
              .sequence = sequence_++,
              .log_time_ns = stamp_ns,
              .publish_time_ns = stamp_ns,
              .data = message_});
}

void RecordEncoder::move_chunk(mcap::Bytes& out, mcap::Compression compression) {
  if (chunk_.messages > 0) mcap::append_chunk(out, chunk_, compression);
  chunk_.clear();
}

/// O_APPEND makes every write go to the end of the file, also after another process has appended to
/// it.
Result<Writer> Writer::open(const std::filesystem::path& file, std::uint32_t at_once,
                            std::uint32_t turn) {
  SWARM_ASSERT(turn < at_once);
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (fd < 0 || !remove_end(fd)) {
    return fail(ErrorCode::kEnvironment, fmt::format("robot log {} cannot be opened: {}",
                                                     file.string(), std::strerror(errno)));
  }
  return Writer(fd, at_once, turn);
}

Writer::Writer(Writer&& other) noexcept { *this = std::move(other); }

/// Swapping leaves the old file to the other writer, whose destructor ends and closes it.
Writer& Writer::operator=(Writer&& other) noexcept {
  if (this == &other) return *this;
  std::swap(fd_, other.fd_);
  std::swap(at_once_, other.at_once_);
  std::swap(until_written_, other.until_written_);
  std::swap(dropped_, other.dropped_);
  std::swap(encoder_, other.encoder_);
  std::swap(buffer_, other.buffer_);
  return *this;
}

/// Writes the waiting records and the end. An empty file gets no end: without a beginning it could
/// not be read.
Writer::~Writer() {
  if (fd_ < 0) return;
  write();
  struct stat status {};
  if (::fstat(fd_, &status) == 0 && status.st_size > 0) {
    const mcap::Bytes& end = mcap::plain_end();
    [[maybe_unused]] const ssize_t ignored = ::write(fd_, end.data(), end.size());
  }
  ::close(fd_);
}

/// A counter, so that many robots of one process can spread their writes over the control steps
/// (`turn`).
void Writer::append(const Record& record) {
  encoder_.add(record);
  if (--until_written_ > 0) return;
  until_written_ = at_once_;
  write();
}

/// One write(2) for each chunk: a killed process leaves whole chunks, apart from the last one.
void Writer::write() {
  const std::uint32_t records = encoder_.waiting();
  if (records == 0) return;
  struct stat before {};
  bool written = ::fstat(fd_, &before) == 0;
  buffer_.clear();
  // An empty file gets the preamble in the same write as its first records.
  if (before.st_size == 0) buffer_ = preamble();
  encoder_.move_chunk(buffer_, mcap::Compression::kNone);
  if (written) {
    ssize_t bytes = -1;
    do {
      bytes = ::write(fd_, buffer_.data(), buffer_.size());
    } while (bytes < 0 && errno == EINTR);
    written = bytes == static_cast<ssize_t>(buffer_.size());
    // A partial record would hide the next one from a simple reader, so it is removed. If that
    // fails too, readers resume at the next chunk.
    if (!written && bytes > 0) [[maybe_unused]]
      const int ignored = ::ftruncate(fd_, before.st_size);
  }
  if (!written) dropped_ += records;
}

Batch::Batch() : bytes_(preamble()) {}

/// Large compressed chunks, since the whole log is in memory and nothing is lost between them.
void Batch::append(const Record& record) {
  constexpr std::uint32_t kRecordsAChunk = 10'000;
  encoder_.add(record);
  if (encoder_.waiting() >= kRecordsAChunk) encoder_.move_chunk(bytes_, mcap::Compression::kZstd);
}

/// Replaces the file, unlike Writer, which appends to it.
Result<void> Batch::write(const std::filesystem::path& file) {
  encoder_.move_chunk(bytes_, mcap::Compression::kZstd);
  const mcap::Bytes& end = mcap::plain_end();
  bytes_.insert(bytes_.end(), end.begin(), end.end());
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "wb"),
                                                               &std::fclose);
  if (!stream || std::fwrite(bytes_.data(), 1, bytes_.size(), stream.get()) != bytes_.size() ||
      std::fflush(stream.get()) != 0) {
    return fail(ErrorCode::kEnvironment, fmt::format("robot log {} cannot be written: {}",
                                                     file.string(), std::strerror(errno)));
  }
  return {};
}

std::optional<RobotRecord> decode(const mcap::Message& message, const mcap::Channel& channel) {
  const auto kind = kind_of(channel.topic);
  return kind ? decode(*kind, message.data) : std::nullopt;
}

/// Messages that are not valid records count as damage.
Result<Damage> read_records(const std::filesystem::path& file,
                            const std::function<void(const Record&)>& take) {
  std::uint64_t malformed = 0;
  auto damage =
      mcap::read(file, {.message = [&](const mcap::Message& message, const mcap::Channel& channel,
                                       const mcap::Schema&) {
                   if (const auto record = decode(message, channel)) {
                     take(record->record);
                   } else {
                     ++malformed;
                   }
                 }});
  if (damage) damage->damaged += malformed;
  return damage;
}

/// A robot that is started again takes its position from here. A file that does not exist is no
/// error: the robot had not recorded a step.
Result<std::vector<Step>> last_steps(const std::filesystem::path& file) {
  std::vector<Step> last;
  if (!std::filesystem::exists(file)) return last;
  const auto read = read_records(file, [&](const Record& record) {
    const auto* step = std::get_if<Step>(&record);
    if (step == nullptr) return;
    if (last.size() == 2) last.erase(last.begin());
    last.push_back(*step);
  });
  if (!read) return tl::unexpected(read.error());
  return last;
}

Result<File> read_file(const std::filesystem::path& file) {
  File result;
  const auto damage =
      read_records(file, [&](const Record& record) { result.records.push_back(record); });
  if (!damage) return tl::unexpected(damage.error());
  static_cast<Damage&>(result) = *damage;
  return result;
}

}  // namespace swarm::robot_log
