// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// MCAP, the container of recordings (https://mcap.dev/spec): records of (u8 opcode, u64 length,
/// content), little-endian, messages in chunks that carry their CRC-32. What is appended here is
/// read by Foxglove, rosbag2 and PlotJuggler.
namespace swarm::mcap {

/// The content of a file, or a part of it.
using Bytes = std::vector<unsigned char>;

/// First and last bytes of a file.
inline constexpr std::string_view kMagic = "\x89MCAP0\r\n";

/// Opcodes of the records.
enum class Op : std::uint8_t {
  kHeader = 0x01,           ///< first record: profile and writing library
  kFooter = 0x02,           ///< last record: where the summary begins
  kSchema = 0x03,           ///< type of the messages of channels
  kChannel = 0x04,          ///< topic with its schema
  kMessage = 0x05,          ///< one message of a channel
  kChunk = 0x06,            ///< schemas, channels and messages, with a checksum
  kMessageIndex = 0x07,     ///< after a chunk: where its messages of one channel are
  kChunkIndex = 0x08,       ///< in the summary: where a chunk is, and its period
  kAttachment = 0x09,       ///< embedded file
  kAttachmentIndex = 0x0A,  ///< in the summary: where an attachment is
  kStatistics = 0x0B,       ///< in the summary: numbers of records and messages
  kMetadata = 0x0C,         ///< named pairs of texts
  kMetadataIndex = 0x0D,    ///< in the summary: where a metadata record is
  kSummaryOffset = 0x0E,    ///< after the summary: where its records of one kind are
  kDataEnd = 0x0F,          ///< end of the data, before the summary
};

/// The type of the messages of a channel.
struct Schema {
  std::uint16_t id = 0;
  std::string name{};      ///< "swarm::wire::FlowPlan"
  std::string encoding{};  ///< "omgidl"
  std::string data{};      ///< the whole IDL
};

/// A topic of a recording; its messages refer to it by id.
struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema = 0;
  std::string topic{};
  std::string encoding{};  ///< "cdr"
  std::map<std::string, std::string> metadata{};
};

/// One recorded message; `data` refers to the caller's bytes or to the file's.
struct Message {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  std::int64_t log_time_ns = 0;      ///< UTC, when it was recorded
  std::int64_t publish_time_ns = 0;  ///< UTC, when it was published
  std::span<const unsigned char> data{};
};

/// A file inside the recording.
struct Attachment {
  std::int64_t log_time_ns = 0;
  std::string name{}, media_type{}, data{};
};

/// Named pairs of texts that describe the recording.
struct Metadata {
  std::string name{};
  std::map<std::string, std::string> values{};
};

/// How chunks are stored.
enum class Compression : std::uint8_t { kNone, kZstd };

/// A chunk that is being filled: its records and their times.
struct ChunkContent {
  Bytes records{};
  std::int64_t begin_ns = 0, end_ns = 0;
  std::uint32_t messages = 0;
  void clear();
  void add(const Message& message);
};

/// Each of these appends one record to `out`.
void append_header(Bytes& out, std::string_view library);
void append_schema(Bytes& out, const Schema& schema);
void append_channel(Bytes& out, const Channel& channel);
void append_message(Bytes& out, const Message& message);
void append_chunk(Bytes& out, const ChunkContent& chunk, Compression compression);
void append_attachment(Bytes& out, const Attachment& attachment);
void append_metadata(Bytes& out, const Metadata& metadata);

/// The end of a file that has no summary.
const Bytes& plain_end();

/// CRC-32 of the bytes, as MCAP demands it.
std::uint32_t crc_of(std::span<const unsigned char> bytes);

/// Appends numbers and texts to bytes, little-endian. The lengths of maps and records are filled in
/// when their content is complete.
class Put {
 public:
  explicit Put(Bytes& out) : out_(out) {}
  template <std::integral T>
  void number(T value) {
    static_assert(std::endian::native == std::endian::little);
    const std::size_t at = out_.size();
    out_.resize(at + sizeof value);
    std::memcpy(out_.data() + at, &value, sizeof value);
  }
  void text(std::string_view text);
  void bytes(std::span<const unsigned char> bytes);
  void map(const std::map<std::string, std::string>& map);

  /// Reserves a length of type T; end_length() sets it to the number of bytes that followed.
  template <class T>
  std::size_t begin_length() {
    number(T{0});
    return out_.size();
  }
  template <class T>
  void end_length(std::size_t begin) {
    const std::uint64_t length = out_.size() - begin;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      out_[begin - sizeof(T) + i] = static_cast<unsigned char>(length >> (8 * i));
    }
  }
  /// Begins a record; end_record() sets its length.
  std::size_t begin_record(Op op) {
    number(static_cast<std::uint8_t>(op));
    return begin_length<std::uint64_t>();
  }
  void end_record(std::size_t begin) { end_length<std::uint64_t>(begin); }

 private:
  Bytes& out_;
};

}  // namespace swarm::mcap
