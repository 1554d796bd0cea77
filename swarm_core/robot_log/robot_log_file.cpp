// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/robot_log/robot_log_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/base/assert.hpp"
#include "swarm_core/files/append_file.hpp"
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

/// A file that this process appends to itself.
class FileSink final : public ChunkSink {
 public:
  explicit FileSink(files::AppendFormat format) : file_(std::move(format)) {}
  ~FileSink() override { file_.finish(disk_); }
  FileSink(const FileSink&) = delete;
  FileSink& operator=(const FileSink&) = delete;

  int open() { return file_.open(disk_); }
  void append(std::span<const unsigned char> chunk, std::uint32_t records) override {
    if (file_.append(disk_, chunk) != 0) dropped_ += records;
  }
  std::uint64_t dropped() const override { return dropped_; }

 private:
  files::RealDisk disk_;
  files::AppendFile file_;
  std::uint64_t dropped_ = 0;
};

files::AppendFormat format_without_header(std::filesystem::path file) {
  return {.file = std::move(file), .preamble = preamble(), .end = mcap::plain_end()};
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

files::AppendFormat format_of(std::filesystem::path file, const Header& header) {
  RecordEncoder encoder;
  encoder.add(header);
  files::AppendFormat format = format_without_header(std::move(file));
  encoder.move_chunk(format.begin, mcap::Compression::kNone);
  return format;
}

Result<Writer> Writer::open(const std::filesystem::path& file, std::uint32_t at_once,
                            std::uint32_t turn) {
  SWARM_ASSERT(turn < at_once);
  auto sink = std::make_unique<FileSink>(format_without_header(file));
  if (const int error = sink->open(); error != 0) {
    return fail(ErrorCode::kEnvironment, fmt::format("robot log {} cannot be opened: {}",
                                                     file.string(), std::strerror(error)));
  }
  return Writer(std::move(sink), at_once, turn);
}

/// The header is encoded here, too, and not written: the records behind it are numbered from 1.
Writer Writer::to(std::unique_ptr<ChunkSink> sink, const Header& header, std::uint32_t at_once,
                  std::uint32_t turn) {
  SWARM_ASSERT(turn < at_once);
  Writer writer(std::move(sink), at_once, turn);
  writer.encoder_.add(header);
  writer.encoder_.move_chunk(writer.buffer_, mcap::Compression::kNone);
  return writer;
}

/// The file that is replaced gets its waiting records and its end first.
Writer& Writer::operator=(Writer&& other) noexcept {
  if (this == &other) return *this;
  if (sink_) flush();
  sink_ = std::move(other.sink_);
  at_once_ = other.at_once_;
  until_written_ = other.until_written_;
  encoder_ = std::move(other.encoder_);
  buffer_ = std::move(other.buffer_);
  return *this;
}

Writer::~Writer() {
  if (sink_) flush();
}

/// A counter, so that many robots of one process can spread their writes over the control steps
/// (`turn`).
void Writer::append(const Record& record) {
  encoder_.add(record);
  if (--until_written_ > 0) return;
  until_written_ = at_once_;
  flush();
}

/// A chunk is written in one piece: a killed process leaves whole chunks, apart from the last one.
void Writer::flush() {
  const std::uint32_t records = encoder_.waiting();
  if (records == 0) return;
  buffer_.clear();
  encoder_.move_chunk(buffer_, mcap::Compression::kNone);
  sink_->append(buffer_, records);
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
                            const std::function<void(const Record&)>& take, UtcTime from) {
  std::uint64_t malformed = 0;
  LostRecords lost;
  const auto read = mcap::read(file, {.message =
                                          [&](const mcap::Message& message,
                                              const mcap::Channel& channel, const mcap::Schema&) {
                                            lost.add(message.sequence);
                                            if (const auto record = decode(message, channel)) {
                                              take(record->record);
                                            } else {
                                              ++malformed;
                                            }
                                          },
                                      .from_ns = from.time_since_epoch().count()});
  if (!read) return tl::unexpected(read.error());
  Damage damage{*read};
  damage.damaged += malformed;
  damage.lost = lost.count();
  return damage;
}

/// A robot that is started again takes its position from here, if no shared memory has it. A file
/// that does not exist is no error: the robot had not recorded a step.
Result<std::vector<Step>> last_steps(const std::filesystem::path& file, UtcTime from) {
  std::vector<Step> last;
  std::error_code unreadable;  // as of a disk that is gone: read_records() reports it
  if (!std::filesystem::exists(file, unreadable) && !unreadable) return last;
  const auto keep_steps = [&](const Record& record) {
    const auto* step = std::get_if<Step>(&record);
    if (step == nullptr) return;
    if (last.size() == 2) last.erase(last.begin());
    last.push_back(*step);
  };
  const auto read = read_records(file, keep_steps, from);
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
