// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/robot_log/reader.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>
#include <unordered_map>

#include <fmt/format.h>
#include <zstd.h>

#include "swarm_core/robot_log/mapped_file.hpp"

namespace swarm::mcap {
namespace {

/// Opcode (1 byte) and length (8 bytes).
constexpr std::size_t kRecordHead = 9;
/// Beyond this a chunk is not unpacked: a few damaged bytes must not exhaust memory.
constexpr std::uint64_t kMaxChunkBytes = 1ULL << 30U;
// A block of zstd has 4 bytes at least and unpacks to 128 KiB at most.
constexpr std::uint64_t kMostUnpacked = (128U << 10U) / 4U;

using View = std::span<const unsigned char>;

/// Reads what Put wrote. Beyond the end everything is 0 and good() is false.
class Get {
 public:
  explicit Get(View in) : in_(in) {}
  template <class T>
  T number() {
    const View bytes = take(sizeof(T));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      value |= static_cast<std::uint64_t>(bytes[i]) << (8 * i);
    }
    return static_cast<T>(value);
  }
  std::string text() {
    const View bytes = take(number<std::uint32_t>());
    return {bytes.begin(), bytes.end()};
  }
  View long_bytes() { return take(number<std::uint64_t>()); }
  std::map<std::string, std::string> map() {
    std::map<std::string, std::string> result;
    Get entries(take(number<std::uint32_t>()));
    while (entries.good_ && !entries.in_.empty()) {
      std::string key = entries.text();
      result[std::move(key)] = entries.text();
    }
    good_ = good_ && entries.good_;
    return result;
  }
  View rest() const { return in_; }
  bool good() const { return good_; }

 private:
  View take(std::uint64_t n) {
    good_ = good_ && n <= in_.size();
    if (!good_) return {};
    const View bytes = in_.first(n);
    in_ = in_.subspan(n);
    return bytes;
  }
  View in_;
  bool good_ = true;
};

/// A record inside the mapped file; `content` refers to its bytes.
struct Record {
  Op op = Op::kHeader;
  View content{};
  std::size_t size = 0;  // with its head
};

/// What could be the record at the front, whole or cut.
struct Front {
  std::optional<Record> record{};
  bool cut = false;  // plausible, but its end is not there
};

/// Opcode 0 is invalid in MCAP. A length beyond the end of the bytes is taken for a truncated file
/// only if opcode and length are plausible, else for damage.
Front front_of(View bytes) {
  if (bytes.size() < kRecordHead) return {.cut = true};
  Get get(bytes);
  const auto op = get.number<std::uint8_t>();
  const auto length = get.number<std::uint64_t>();
  if (op == 0) return {};
  if (length > bytes.size() - kRecordHead) return {.cut = op <= 0x0F && length < kMaxChunkBytes};
  return {.record = Record{.op = static_cast<Op>(op),
                           .content = bytes.subspan(kRecordHead, length),
                           .size = kRecordHead + length}};
}

/// Whether the bytes after a record could be the next one, or the end of the file.
bool could_follow(View bytes) {
  constexpr std::size_t kLeast = 4;  // content of a data end, the shortest record of the format
  const auto next = front_of(bytes).record;
  return bytes.empty() || (next && (next->op > Op::kDataEnd || next->content.size() >= kLeast));
}

/// The fields of a chunk, and whether all of them are there.
struct ChunkFields {
  std::int64_t begin_ns = 0, end_ns = 0;
  std::uint64_t size = 0;  // unpacked
  std::uint32_t crc = 0;
  std::string compression{};
  View records{};
  View beyond{};  // fields of a later version of the format
  bool good = false;
};

ChunkFields chunk_fields(View content) {
  Get get(content);
  ChunkFields chunk;
  chunk.begin_ns = get.number<std::int64_t>();
  chunk.end_ns = get.number<std::int64_t>();
  chunk.size = get.number<std::uint64_t>();
  chunk.crc = get.number<std::uint32_t>();
  chunk.compression = get.text();
  chunk.records = get.long_bytes();
  chunk.beyond = get.rest();
  chunk.good = get.good() && chunk.size <= kMaxChunkBytes;
  return chunk;
}

/// Checked before there is memory for it: a damaged size may be a gigabyte.
bool could_unpack_to(View packed, std::uint64_t size) {
  return size / kMostUnpacked <= packed.size();
}

/// One pass over the records of a file. After a damaged record it searches for the next chunk with
/// a correct checksum. Records may be longer than the fields known here, and their opcodes may be
/// unknown, as the format may grow by both. A damaged length or opcode looks the same, so
/// such a record counts only if another one follows it.
class FileReader {
 public:
  explicit FileReader(const Handlers& handlers) : handlers_(handlers) {}

  /// The compression of the chunks if it is unknown here and not one chunk could be unpacked;
  /// otherwise empty. A single chunk with an unknown compression is damaged.
  const std::string& unknown_compression() const {
    static const std::string kNone;
    return any_unpacked_ ? kNone : unknown_compression_;
  }

  Damage read(View bytes) {
    View rest = bytes.subspan(kMagic.size());
    bool in_damage = false;
    while (!rest.empty()) {
      if (damage_.ended || (handlers_.go_on && !handlers_.go_on())) break;
      const Front front = front_of(rest);
      // After damage reading resumes at a chunk only, whose checksum proves that it is a record.
      if (front.record) after_ = rest.subspan(front.record->size);
      const bool chunk = front.record && front.record->op == Op::kChunk;
      const bool trusted =
          front.record && (chunk || !(in_damage || is_chunk(front.record->content)));
      if (trusted && take(*front.record)) {
        rest = rest.subspan(front.record->size);
        in_damage = false;
        continue;
      }
      if (!in_damage) {
        damage_.truncated = front.cut;
        ++damage_.damaged;
        in_damage = true;
      }
      // The length of a damaged record may be wrong: search for the next chunk byte by byte.
      const auto* next = static_cast<const unsigned char*>(
          std::memchr(rest.data() + 1, static_cast<int>(Op::kChunk), rest.size() - 1));
      rest = next == nullptr ? View() : rest.subspan(static_cast<std::size_t>(next - rest.data()));
    }
    // A truncated last record is reported as such and not as damage; if whole records followed
    // after all, it was damage.
    if (damage_.truncated && in_damage) --damage_.damaged;
    if (!in_damage) damage_.truncated = false;
    return damage_;
  }

 private:
  /// False if the content does not match the opcode.
  bool take(const Record& record) {
    switch (record.op) {
      case Op::kSchema:
        return take_schema(record.content);
      case Op::kChannel:
        return take_channel(record.content);
      case Op::kMessage:
        return take_message(record.content);
      case Op::kChunk:
        return take_chunk(record.content);
      case Op::kAttachment:
        return take_attachment(record.content);
      case Op::kMetadata:
        return take_metadata(record.content);
      case Op::kDataEnd:
        damage_.ended = true;  // the summary that follows repeats data that was read already
        return true;
      case Op::kHeader:
        return true;
      case Op::kMessageIndex: {
        Get get(record.content);
        get.number<std::uint16_t>();
        const std::size_t entries = get.number<std::uint32_t>();
        const std::size_t rest = get.rest().size();
        return get.good() && (entries == rest || (entries < rest && could_follow(after_)));
      }
      default:
        // The other opcodes of the format occur only after the data end.
        if (static_cast<std::uint8_t>(record.op) <= static_cast<std::uint8_t>(Op::kDataEnd)) {
          return false;
        }
        // Of a later version of the format, or (from 0x80 on) of an application.
        return could_follow(after_);
    }
  }

  /// Whether the content of another record is that of a chunk with a correct checksum: then the
  /// opcode is damaged.
  bool is_chunk(View content) {
    const ChunkFields chunk = chunk_fields(content);
    return chunk.good && chunk.crc != 0 && unpack(chunk).has_value();
  }

  // Schemas and channels may be repeated in a file; the last one counts.
  bool take_schema(View content) {
    Get get(content);
    Schema schema;
    schema.id = get.number<std::uint16_t>();
    schema.name = get.text();
    schema.encoding = get.text();
    schema.data = get.text();
    if (get.good()) schemas_[schema.id] = std::move(schema);
    return get.good();
  }

  bool take_channel(View content) {
    Get get(content);
    Channel channel;
    channel.id = get.number<std::uint16_t>();
    channel.schema = get.number<std::uint16_t>();
    channel.topic = get.text();
    channel.encoding = get.text();
    channel.metadata = get.map();
    if (get.good()) channels_[channel.id] = std::move(channel);
    return get.good();
  }

  // A message of an unknown channel cannot be decoded and counts as damage.
  bool take_message(View content) {
    Get get(content);
    Message message;
    message.channel = get.number<std::uint16_t>();
    message.sequence = get.number<std::uint32_t>();
    message.log_time_ns = get.number<std::int64_t>();
    message.publish_time_ns = get.number<std::int64_t>();
    message.data = get.rest();
    const auto channel = channels_.find(message.channel);
    if (!get.good() || channel == channels_.end()) return false;
    if (handlers_.message && message.log_time_ns >= handlers_.from_ns) {
      handlers_.message(message, channel->second, schemas_[channel->second.schema]);
    }
    return true;
  }

  // Checks size, checksum and times of a chunk before it passes on the first message: handlers
  // receive no message of a chunk whose checksum is wrong.
  bool take_chunk(View content) {
    const ChunkFields chunk = chunk_fields(content);
    if (!chunk.good || (!chunk.beyond.empty() && !could_follow(after_))) return false;
    // A chunk may declare channels, so none is skipped before the first channel is known.
    if (chunk.end_ns < handlers_.from_ns && !channels_.empty()) return true;
    const auto unpacked = unpack(chunk);
    if (!unpacked || !times_are(*unpacked, chunk.begin_ns, chunk.end_ns)) return false;
    any_unpacked_ = true;
    View records = *unpacked;
    while (!records.empty()) {
      const Front front = front_of(records);
      const Op op = front.record->op;
      if ((op == Op::kSchema || op == Op::kChannel || op == Op::kMessage) && !take(*front.record)) {
        ++damage_.damaged;
      }
      records = records.subspan(front.record->size);
    }
    return true;
  }

  /// The records of a chunk; nothing if size or checksum are wrong or the compression is unknown.
  std::optional<View> unpack(const ChunkFields& chunk) {
    View records = chunk.records;
    if (chunk.compression == "zstd") {
      if (!could_unpack_to(records, chunk.size)) return std::nullopt;
      unpacked_.resize(chunk.size);
      if (::ZSTD_decompress(unpacked_.data(), chunk.size, records.data(), records.size()) !=
          chunk.size) {
        return std::nullopt;
      }
      records = unpacked_;
    } else if (!chunk.compression.empty()) {
      if (unknown_compression_.empty()) unknown_compression_ = chunk.compression;
      return std::nullopt;
    }
    if (records.size() != chunk.size || (chunk.crc != 0 && crc_of(records) != chunk.crc)) {
      return std::nullopt;
    }
    return records;
  }

  /// Whether a chunk consists of whole records and its begin and end time, which the checksum does
  /// not cover, are those of its messages.
  static bool times_are(View records, std::int64_t begin_ns, std::int64_t end_ns) {
    std::int64_t first = std::numeric_limits<std::int64_t>::max();
    std::int64_t last = std::numeric_limits<std::int64_t>::min();
    while (!records.empty()) {
      const Front front = front_of(records);
      if (!front.record) return false;
      if (front.record->op == Op::kMessage) {
        Get get(front.record->content);
        get.number<std::uint16_t>();
        get.number<std::uint32_t>();
        const auto log_time_ns = get.number<std::int64_t>();
        first = std::min(first, log_time_ns);
        last = std::max(last, log_time_ns);
      }
      records = records.subspan(front.record->size);
    }
    return first > last || (first == begin_ns && last == end_ns);
  }

  bool take_attachment(View content) {
    Get get(content);
    Attachment attachment;
    attachment.log_time_ns = get.number<std::int64_t>();
    get.number<std::int64_t>();
    attachment.name = get.text();
    attachment.media_type = get.text();
    const View data = get.long_bytes();
    // The checksum covers the record's content up to itself.
    const View signed_part = content.first(content.size() - get.rest().size());
    const auto crc = get.number<std::uint32_t>();
    if (!get.good()) return false;
    if (crc != 0 && crc_of(signed_part) != crc) {
      // With a length that is right the damage costs this attachment alone.
      if (!could_follow(after_)) return false;
      ++damage_.damaged;
      return true;
    }
    attachment.data.assign(data.begin(), data.end());
    if (handlers_.attachment) handlers_.attachment(attachment);
    return true;
  }

  bool take_metadata(View content) {
    Get get(content);
    Metadata metadata;
    metadata.name = get.text();
    metadata.values = get.map();
    if (get.good() && handlers_.metadata) handlers_.metadata(metadata);
    return get.good();
  }

  const Handlers& handlers_;
  Damage damage_;
  std::unordered_map<std::uint16_t, Schema> schemas_;
  std::unordered_map<std::uint16_t, Channel> channels_;
  Bytes unpacked_;
  View after_;  // what follows the record that is being read
  std::string unknown_compression_;
  bool any_unpacked_ = false;
};

/// A text of a file as it may be printed: its first printable characters.
std::string printable(const std::string& text) {
  constexpr std::size_t kShown = 32;
  std::string shown;
  for (const char c : text.substr(0, kShown)) shown += c >= ' ' && c <= '~' ? c : '?';
  return shown;
}

}  // namespace

/// An empty file is not an error: a writer that was killed before its first write leaves one.
Result<Damage> read(const std::filesystem::path& file, const Handlers& handlers) {
  const auto mapped = MappedFile::open(file);
  if (!mapped) return tl::unexpected(mapped.error());
  const View bytes = mapped->bytes();
  if (bytes.empty()) return Damage{.truncated = true};
  if (bytes.size() < kMagic.size() ||
      std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0) {
    return fail(ErrorCode::kBadInput,
                fmt::format("{}: no recording: it does not begin as MCAP files do", file.string()));
  }
  FileReader reader(handlers);
  const Damage damage = reader.read(bytes);
  if (const std::string& name = reader.unknown_compression(); !name.empty()) {
    return fail(ErrorCode::kBadInput,
                fmt::format("{}: its chunks are compressed by '{}'; this program reads zstd and "
                            "uncompressed chunks",
                            file.string(), printable(name)));
  }
  return damage;
}

}  // namespace swarm::mcap
