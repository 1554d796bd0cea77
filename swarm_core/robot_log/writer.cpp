// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/robot_log/writer.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "swarm_core/base/assert.hpp"

namespace swarm::mcap {
namespace {

// Uncompressed size from which a chunk is closed: larger ones compress better, smaller ones lose
// less.
constexpr std::size_t kChunkBytes = 1U << 20U;
constexpr std::string_view kLibrary = "swarmflow " SWARM_VERSION;

}  // namespace

// O_EXCL refuses an existing file without a race between test and creation.
Result<Writer> Writer::create(const std::filesystem::path& file, Compression compression) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (fd < 0) {
    return fail(ErrorCode::kEnvironment, fmt::format("recording {} cannot be made: {}",
                                                     file.string(), std::strerror(errno)));
  }
  Writer writer;
  writer.fd_ = fd;
  writer.file_ = file;
  writer.compression_ = compression;
  Bytes head(kMagic.begin(), kMagic.end());
  append_header(head, kLibrary);
  if (!writer.put(head)) {
    return fail(ErrorCode::kEnvironment, fmt::format("recording {} cannot be written: {}",
                                                     file.string(), std::strerror(errno)));
  }
  return writer;
}

// `scratch_` holds nothing between calls and is not moved.
Writer& Writer::operator=(Writer&& other) noexcept {
  if (this == &other) return *this;
  std::swap(fd_, other.fd_);
  file_ = std::move(other.file_);
  compression_ = other.compression_;
  size_ = other.size_;
  schemas_ = std::move(other.schemas_);
  channels_ = std::move(other.channels_);
  sequences_ = std::move(other.sequences_);
  counts_ = std::move(other.counts_);
  entries_ = std::move(other.entries_);
  chunk_ = std::move(other.chunk_);
  chunks_ = std::move(other.chunks_);
  attachments_ = std::move(other.attachments_);
  metadata_ = std::move(other.metadata_);
  lost_declarations_ = std::move(other.lost_declarations_);
  messages_ = other.messages_;
  dropped_ = other.dropped_;
  return *this;
}

Writer::~Writer() {
  if (fd_ >= 0) [[maybe_unused]]
    const auto finished = finish();
}

// Writes all bytes or, if the disk refuses, removes the part that it took. Keeps errno for the
// caller.
bool Writer::put(const Bytes& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::write(fd_, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    done += static_cast<std::size_t>(n);
  }
  if (done == bytes.size()) {
    size_ += done;
    return true;
  }
  // A partial record would end the file for simple readers, so it is removed.
  const int reason = errno;
  if (done > 0 && ::ftruncate(fd_, static_cast<off_t>(size_)) == 0) {
    ::lseek(fd_, static_cast<off_t>(size_), SEEK_SET);
  }
  errno = reason;
  return false;
}

// Declarations are written outside of chunks, after the current chunk and before the first one that
// uses them. Declarations that the disk refused are written again before the next chunk.
std::uint16_t Writer::add_channel(const std::string& topic, const Schema& schema,
                                  const std::map<std::string, std::string>& metadata) {
  flush();
  Bytes declarations;
  auto known = std::find_if(schemas_.begin(), schemas_.end(), [&](const Schema& other) {
    return other.name == schema.name && other.data == schema.data;
  });
  if (known == schemas_.end()) {
    SWARM_ASSERT(schemas_.size() < std::numeric_limits<std::uint16_t>::max());
    known = schemas_.insert(known, schema);
    known->id = static_cast<std::uint16_t>(schemas_.size());  // 0 is none
    append_schema(declarations, *known);
  }
  SWARM_ASSERT(channels_.size() < std::numeric_limits<std::uint16_t>::max());
  channels_.push_back({.id = static_cast<std::uint16_t>(channels_.size()),
                       .schema = known->id,
                       .topic = topic,
                       .encoding = "cdr",
                       .metadata = metadata});
  append_channel(declarations, channels_.back());
  sequences_.push_back(0);
  counts_.push_back(0);
  entries_.emplace_back();
  if (!put(declarations)) {
    lost_declarations_.insert(lost_declarations_.end(), declarations.begin(), declarations.end());
  }
  return channels_.back().id;
}

void Writer::add(const Attachment& attachment) {
  flush();
  scratch_.clear();
  append_attachment(scratch_, attachment);
  const Place place{.offset = size_, .length = scratch_.size()};
  if (!put(scratch_)) {
    ++dropped_;
    return;
  }
  attachments_.emplace_back(attachment, place);
}

void Writer::add(const Metadata& metadata) {
  flush();
  scratch_.clear();
  append_metadata(scratch_, metadata);
  const Place place{.offset = size_, .length = scratch_.size()};
  if (put(scratch_)) metadata_.emplace_back(metadata.name, place);
}

// Messages collect in a chunk; the entries remember time and offset of each for the chunk's index.
void Writer::write(std::uint16_t channel, std::int64_t log_time_ns, std::int64_t publish_time_ns,
                   std::span<const unsigned char> data) {
  SWARM_ASSERT(channel < channels_.size());
  entries_[channel].push_back({log_time_ns, chunk_.records.size()});
  chunk_.add({.channel = channel,
              .sequence = sequences_[channel]++,
              .log_time_ns = log_time_ns,
              .publish_time_ns = publish_time_ns,
              .data = data});
  if (chunk_.records.size() >= kChunkBytes) flush();
}

// Chunk and message indexes go to the disk in one write, so that it has both or neither.
void Writer::flush() {
  if (chunk_.messages == 0) return;
  scratch_ = lost_declarations_;
  ChunkPlace place{.begin_ns = chunk_.begin_ns,
                   .end_ns = chunk_.end_ns,
                   .offset = size_ + scratch_.size(),
                   .uncompressed = chunk_.records.size()};
  append_chunk(scratch_, chunk_, compression_);
  place.length = size_ + scratch_.size() - place.offset;
  // Head of the record, five numbers, the compression's name and two lengths come before.
  const std::size_t name = compression_ == Compression::kZstd ? 4 : 0;
  place.compressed = place.length - (9 + 8 + 8 + 8 + 4 + 4 + name + 8);
  Put put_numbers(scratch_);
  for (std::size_t channel = 0; channel < entries_.size(); ++channel) {
    if (entries_[channel].empty()) continue;
    place.index_offsets[static_cast<std::uint16_t>(channel)] = size_ + scratch_.size();
    const std::size_t record = put_numbers.begin_record(Op::kMessageIndex);
    put_numbers.number(static_cast<std::uint16_t>(channel));
    const std::size_t array = put_numbers.begin_length<std::uint32_t>();
    for (const Entry& entry : entries_[channel]) {
      put_numbers.number(entry.log_time_ns);
      put_numbers.number(entry.offset);
    }
    put_numbers.end_length<std::uint32_t>(array);
    put_numbers.end_record(record);
  }
  place.index_length = size_ + scratch_.size() - place.offset - place.length;
  // Only chunks that the disk took are counted and indexed.
  if (put(scratch_)) {
    lost_declarations_.clear();
    messages_ += chunk_.messages;
    for (std::size_t i = 0; i < entries_.size(); ++i) counts_[i] += entries_[i].size();
    chunks_.push_back(std::move(place));
  } else {
    dropped_ += chunk_.messages;
  }
  for (auto& entries : entries_) entries.clear();
  chunk_.clear();
}

// The file is closed even if its end could not be written: readers do without it.
Result<void> Writer::finish() {
  flush();
  scratch_.clear();
  Put end(scratch_);
  const std::size_t record = end.begin_record(Op::kDataEnd);
  end.number(std::uint32_t{0});  // no CRC of all that went before: chunks have theirs
  end.end_record(record);
  Bytes summary;
  append_summary(summary, size_ + scratch_.size());
  scratch_.insert(scratch_.end(), summary.begin(), summary.end());
  const bool written = put(scratch_) && ::fsync(fd_) == 0;
  const int reason = errno;
  ::close(std::exchange(fd_, -1));
  if (!written) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("recording {} lacks its end: {}; it can be read without",
                            file_.string(), std::strerror(reason)));
  }
  if (dropped_ > 0) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("recording {} lacks {} messages that the disk did not take",
                            file_.string(), dropped_));
  }
  return {};
}

}  // namespace swarm::mcap
