// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/robot_log/record_codec.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstring>
#include <string_view>

namespace swarm::robot_log {
namespace {

constexpr std::size_t kEncapsulationBytes = 4;
constexpr std::array<unsigned char, kEncapsulationBytes> kPlainLittleEndian = {0, 1, 0, 0};

/// Writes values as CDR: each at a multiple of its size, counted from the end of the encapsulation
/// header.
class Encoder {
 public:
  explicit Encoder(std::vector<unsigned char>& out) : out_(out) {
    out_.assign(kPlainLittleEndian.begin(), kPlainLittleEndian.end());
  }

  template <std::unsigned_integral T>
  void put(T value) {
    static_assert(std::endian::native == std::endian::little);
    const std::size_t misaligned = (out_.size() - kEncapsulationBytes) % sizeof(T);
    const std::size_t at = out_.size() + (misaligned == 0 ? 0 : sizeof(T) - misaligned);
    out_.resize(at + sizeof(T));
    std::memcpy(out_.data() + at, &value, sizeof(T));
  }
  /// Pads the message to a multiple of four bytes, as RTPS does: a message that is published again
  /// in a replay then has the same bytes as the recorded one.
  void finish() { out_.resize((out_.size() + 3) / 4 * 4); }
  void put(float value) { put(std::bit_cast<std::uint32_t>(value)); }
  void put(double value) { put(std::bit_cast<std::uint64_t>(value)); }
  void put(UtcTime stamp) { put(static_cast<std::uint64_t>(stamp.time_since_epoch().count())); }
  void put(const Vec2& v) {
    put(v.x());
    put(v.y());
  }
  void put(std::string_view text) {
    text = text.substr(0, kMaxNoteText);
    put(static_cast<std::uint32_t>(text.size() + 1));
    out_.insert(out_.end(), text.begin(), text.end());
    out_.push_back(0);
  }

 private:
  std::vector<unsigned char>& out_;
};

/// Reads what Encoder wrote. Beyond the end everything is 0 and good() is false.
class Decoder {
 public:
  explicit Decoder(std::span<const unsigned char> in) : size_(in.size()), in_(in) {
    const auto head = take(kEncapsulationBytes);
    good_ = good_ && std::equal(head.begin(), head.end(), kPlainLittleEndian.begin());
  }

  template <std::unsigned_integral T>
  T get() {
    const std::size_t at = size_ - in_.size() - kEncapsulationBytes;
    take((sizeof(T) - at % sizeof(T)) % sizeof(T));
    const auto bytes = take(sizeof(T));
    T value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      value = static_cast<T>(value | static_cast<T>(static_cast<T>(bytes[i]) << (8U * i)));
    }
    return value;
  }
  // Numbers that are not finite are refused: no record has any.
  double get_double() {
    const double value = std::bit_cast<double>(get<std::uint64_t>());
    good_ = good_ && std::isfinite(value);
    return value;
  }
  float get_float() {
    const float value = std::bit_cast<float>(get<std::uint32_t>());
    good_ = good_ && std::isfinite(value);
    return value;
  }
  Vec2 get_vec2() {
    const double x = get_double();
    return {x, get_double()};
  }
  UtcTime get_time() { return UtcTime(Duration(static_cast<std::int64_t>(get<std::uint64_t>()))); }
  // CDR counts the terminating 0 in the length of a string.
  std::string get_text() {
    const auto bytes = take(get<std::uint32_t>());
    good_ = good_ && !bytes.empty() && bytes.back() == 0 && bytes.size() <= kMaxNoteText + 1;
    return good_ ? std::string(bytes.begin(), bytes.end() - 1) : std::string();
  }
  void refuse() { good_ = false; }

  /// Whether all values read were present and well-formed and only padding is left.
  bool finished() const { return good_ && in_.size() < 4; }
  bool good() const { return good_; }

 private:
  std::span<const unsigned char> take(std::size_t n) {
    good_ = good_ && n <= in_.size();
    if (!good_) return {};
    const auto bytes = in_.first(n);
    in_ = in_.subspan(n);
    return bytes;
  }

  std::size_t size_;
  std::span<const unsigned char> in_;
  bool good_ = true;
};

/// The fields in the order of idl/blackbox.idl, as in all functions put() and get() below.
void put(Encoder& out, RobotId robot, const Header& header) {
  out.put(header.stamp);
  out.put(robot.value());
  out.put(header.robots);
  out.put(header.process_id);
  out.put(header.radius_m);
}

void put(Encoder& out, RobotId robot, const Step& step) {
  out.put(step.stamp);
  out.put(robot.value());
  out.put(static_cast<std::uint32_t>(step.lateness_us));
  out.put(step.position_m);
  out.put(step.velocity_mps);
  out.put(step.mode);
  out.put(step.goal);
  out.put(step.neighbours);
  out.put(step.plan_version);
  out.put(step.plan_time_s);
  out.put(step.reference_x_m);
  out.put(step.reference_y_m);
}

void put(Encoder& out, RobotId robot, const Estimate& estimate) {
  out.put(estimate.stamp);
  out.put(robot.value());
  out.put(estimate.neighbour.value());
  out.put(estimate.position_m);
}

/// Histograms are mostly empty, so only the bins with samples are written, each with its index.
void put(Encoder& out, RobotId robot, const LinkStats& stats) {
  out.put(stats.stamp);
  out.put(robot.value());
  out.put(stats.states_sent);
  out.put(stats.states_received);
  const std::size_t refusals = std::min(stats.refused.size(), kMaxRefusals);
  out.put(static_cast<std::uint32_t>(refusals));
  for (std::size_t i = 0; i < refusals; ++i) out.put(stats.refused[i]);
  std::uint32_t bins = 0;
  for (std::size_t i = 0; i < Histogram::kBins; ++i) {
    if (stats.state_age.bin(i) > 0) ++bins;
  }
  out.put(bins);
  for (std::size_t i = 0; i < Histogram::kBins; ++i) {
    if (stats.state_age.bin(i) == 0) continue;
    out.put(static_cast<std::uint16_t>(i));
    out.put(stats.state_age.bin(i));
  }
}

void put(Encoder& out, RobotId robot, const Note& note) {
  out.put(note.stamp);
  out.put(note.caused);
  out.put(robot.value());
  out.put(std::string_view(note.code));
  out.put(std::string_view(note.text));
}

RobotId get(Decoder& in, Header& header) {
  header.stamp = in.get_time();
  header.robot = RobotId(in.get<std::uint32_t>());
  header.robots = in.get<std::uint32_t>();
  header.process_id = in.get<std::uint32_t>();
  header.radius_m = in.get_double();
  return header.robot;
}

RobotId get(Decoder& in, Step& step) {
  step.stamp = in.get_time();
  const RobotId robot(in.get<std::uint32_t>());
  step.lateness_us = static_cast<std::int32_t>(in.get<std::uint32_t>());
  step.position_m = in.get_vec2();
  step.velocity_mps = in.get_vec2();
  step.mode = in.get<std::uint8_t>();
  step.goal = in.get<std::uint8_t>();
  step.neighbours = in.get<std::uint16_t>();
  step.plan_version = in.get<std::uint32_t>();
  step.plan_time_s = in.get_float();
  step.reference_x_m = in.get_float();
  step.reference_y_m = in.get_float();
  return robot;
}

RobotId get(Decoder& in, Estimate& estimate) {
  estimate.stamp = in.get_time();
  const RobotId robot(in.get<std::uint32_t>());
  estimate.neighbour = RobotId(in.get<std::uint32_t>());
  estimate.position_m = in.get_vec2();
  return robot;
}

/// Counts come from a file and are checked before they are used: a loop ends at the first missing
/// value.
RobotId get(Decoder& in, LinkStats& stats) {
  stats.stamp = in.get_time();
  const RobotId robot(in.get<std::uint32_t>());
  stats.states_sent = in.get<std::uint32_t>();
  stats.states_received = in.get<std::uint32_t>();
  const auto refusals = in.get<std::uint32_t>();
  if (refusals > kMaxRefusals) in.refuse();
  for (std::uint32_t i = 0; i < refusals && in.good(); ++i) {
    stats.refused.push_back(in.get<std::uint32_t>());
  }
  const auto bins = in.get<std::uint32_t>();
  for (std::uint32_t i = 0; i < bins && in.good(); ++i) {
    const std::size_t bin = in.get<std::uint16_t>();
    const std::uint64_t count = in.get<std::uint64_t>();
    if (bin < Histogram::kBins) {
      stats.state_age.add_bin(bin, count);
    } else {
      in.refuse();
    }
  }
  return robot;
}

RobotId get(Decoder& in, Note& note) {
  note.stamp = in.get_time();
  note.caused = in.get_time();
  const RobotId robot(in.get<std::uint32_t>());
  note.code = in.get_text();
  note.text = in.get_text();
  return robot;
}

/// Returned by value and only when the whole message was valid.
template <class R>
std::optional<RobotRecord> decode_as(std::span<const unsigned char> message) {
  Decoder in(message);
  R record;
  const RobotId robot = get(in, record);
  if (!in.finished()) return std::nullopt;
  return RobotRecord{.robot = robot, .record = std::move(record)};
}

}  // namespace

/// In the order of the alternatives of Record: the index is also the channel's number in robot
/// logs.
const std::array<Kind, std::variant_size_v<Record>>& kinds() {
  static const std::array<Kind, std::variant_size_v<Record>> kKinds = {
      {{"blackbox/header", "swarm::blackbox::Header", {"Header"}},
       {"blackbox/step", "swarm::blackbox::Step", {"Step"}},
       {"blackbox/belief", "swarm::blackbox::Belief", {"Belief"}},
       {"blackbox/link_stats", "swarm::blackbox::LinkStats", {"HistogramBin", "LinkStats"}},
       {"blackbox/note", "swarm::blackbox::Note", {"Note"}}}};
  return kKinds;
}

/// The robot's id is a parameter because most records of a log do not hold it.
void encode(RobotId robot, const Record& record, std::vector<unsigned char>& out) {
  Encoder encoder(out);
  std::visit([&](const auto& r) { put(encoder, robot, r); }, record);
  encoder.finish();
}

std::optional<RobotRecord> decode(std::size_t kind, std::span<const unsigned char> message) {
  switch (kind) {
    case 0:
      return decode_as<Header>(message);
    case 1:
      return decode_as<Step>(message);
    case 2:
      return decode_as<Estimate>(message);
    case 3:
      return decode_as<LinkStats>(message);
    case 4:
      return decode_as<Note>(message);
    default:
      return std::nullopt;
  }
}

}  // namespace swarm::robot_log
