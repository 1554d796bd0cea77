// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/blackbox/record_codec.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <string_view>

namespace swarm::blackbox {
namespace {

enum Kind : std::uint8_t { kHeader = 1, kStep = 2, kLinkStats = 3, kNote = 4, kBelief = 5 };

constexpr std::size_t kHeaderBytes = 4 + 4 + 4 + 8 + 8;
constexpr std::size_t kStepBytes = 8 + 4 * 8 + 4 + 1 + 1 + 2;
constexpr std::size_t kBeliefBytes = 8 + 4 + 2 * 8;
constexpr std::size_t kLeastStatsBytes = 8 + 4 + 4 + 1 + 2;
constexpr std::size_t kMostStatsBytes = kLeastStatsBytes + 4 * kMaxRefusals + 10 * Histogram::kBins;
constexpr std::size_t kLeastNoteBytes = 8 + 8 + 2 + 2;
constexpr std::size_t kMostNoteBytes = kLeastNoteBytes + 2 * kMaxNoteText;

class Encoder {
 public:
  explicit Encoder(std::vector<unsigned char>& out) : out_(out) {}

  template <std::unsigned_integral T>
  void put(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      out_.push_back(static_cast<unsigned char>(value >> (8U * i)));
    }
  }
  void put(double value) { put(std::bit_cast<std::uint64_t>(value)); }
  void put(UtcTime stamp) { put(static_cast<std::uint64_t>(stamp.time_since_epoch().count())); }
  void put(const Vec2& v) {
    put(v.x());
    put(v.y());
  }
  void put(std::string_view text) {
    text = text.substr(0, kMaxNoteText);
    put(static_cast<std::uint16_t>(text.size()));
    out_.insert(out_.end(), text.begin(), text.end());
  }

 private:
  std::vector<unsigned char>& out_;
};

/// Reads what Encoder wrote. Beyond the end everything is 0 and good() is false.
class Decoder {
 public:
  explicit Decoder(std::span<const unsigned char> in) : in_(in) {}

  template <std::unsigned_integral T>
  T get() {
    const auto bytes = take(sizeof(T));
    T value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      value = static_cast<T>(value | static_cast<T>(static_cast<T>(bytes[i]) << (8U * i)));
    }
    return value;
  }
  double get_double() {
    const double value = std::bit_cast<double>(get<std::uint64_t>());
    good_ = good_ && std::isfinite(value);
    return value;
  }
  Vec2 get_vec2() {
    const double x = get_double();
    return {x, get_double()};
  }
  UtcTime get_time() { return UtcTime(Duration(static_cast<std::int64_t>(get<std::uint64_t>()))); }
  std::string get_text() {
    const auto bytes = take(get<std::uint16_t>());
    return {bytes.begin(), bytes.end()};
  }
  void refuse() { good_ = false; }

  /// Whether everything read was there and well-formed, and nothing is left over.
  bool finished() const { return good_ && in_.empty(); }
  bool good() const { return good_; }

 private:
  std::span<const unsigned char> take(std::size_t n) {
    good_ = good_ && n <= in_.size();
    if (!good_) return {};
    const auto bytes = in_.first(n);
    in_ = in_.subspan(n);
    return bytes;
  }

  std::span<const unsigned char> in_;
  bool good_ = true;
};

Kind put(Encoder& out, const Header& header) {
  out.put(header.robot.value());
  out.put(header.robots);
  out.put(header.process_id);
  out.put(header.radius_m);
  out.put(header.stamp);
  return kHeader;
}

Kind put(Encoder& out, const Step& step) {
  out.put(step.stamp);
  out.put(step.position_m);
  out.put(step.velocity_mps);
  out.put(static_cast<std::uint32_t>(step.lateness_us));
  out.put(step.mode);
  out.put(step.goal);
  out.put(step.neighbours);
  return kStep;
}

Kind put(Encoder& out, const Belief& belief) {
  out.put(belief.stamp);
  out.put(belief.neighbour.value());
  out.put(belief.position_m);
  return kBelief;
}

Kind put(Encoder& out, const LinkStats& stats) {
  out.put(stats.stamp);
  out.put(stats.states_sent);
  out.put(stats.states_received);
  const std::size_t refusals = std::min(stats.refused.size(), kMaxRefusals);
  out.put(static_cast<std::uint8_t>(refusals));
  for (std::size_t i = 0; i < refusals; ++i) out.put(stats.refused[i]);
  std::uint16_t bins = 0;
  for (std::size_t i = 0; i < Histogram::kBins; ++i) {
    if (stats.state_age.bin(i) > 0) ++bins;
  }
  out.put(bins);
  for (std::size_t i = 0; i < Histogram::kBins; ++i) {
    if (stats.state_age.bin(i) == 0) continue;
    out.put(static_cast<std::uint16_t>(i));
    out.put(stats.state_age.bin(i));
  }
  return kLinkStats;
}

Kind put(Encoder& out, const Note& note) {
  out.put(note.stamp);
  out.put(note.caused);
  out.put(std::string_view(note.code));
  out.put(std::string_view(note.text));
  return kNote;
}

Header get_header(Decoder& in) {
  Header header;
  header.robot = RobotId(in.get<std::uint32_t>());
  header.robots = in.get<std::uint32_t>();
  header.process_id = in.get<std::uint32_t>();
  header.radius_m = in.get_double();
  header.stamp = in.get_time();
  return header;
}

Step get_step(Decoder& in) {
  Step step;
  step.stamp = in.get_time();
  step.position_m = in.get_vec2();
  step.velocity_mps = in.get_vec2();
  step.lateness_us = static_cast<std::int32_t>(in.get<std::uint32_t>());
  step.mode = in.get<std::uint8_t>();
  step.goal = in.get<std::uint8_t>();
  step.neighbours = in.get<std::uint16_t>();
  return step;
}

Belief get_belief(Decoder& in) {
  Belief belief;
  belief.stamp = in.get_time();
  belief.neighbour = RobotId(in.get<std::uint32_t>());
  belief.position_m = in.get_vec2();
  return belief;
}

LinkStats get_link_stats(Decoder& in) {
  LinkStats stats;
  stats.stamp = in.get_time();
  stats.states_sent = in.get<std::uint32_t>();
  stats.states_received = in.get<std::uint32_t>();
  stats.refused.resize(in.get<std::uint8_t>());
  for (std::uint32_t& count : stats.refused) count = in.get<std::uint32_t>();
  const std::size_t bins = in.get<std::uint16_t>();
  for (std::size_t i = 0; i < bins && in.good(); ++i) {
    const std::size_t bin = in.get<std::uint16_t>();
    const std::uint64_t count = in.get<std::uint64_t>();
    if (bin < Histogram::kBins) {
      stats.state_age.add_bin(bin, count);
    } else {
      in.refuse();
    }
  }
  return stats;
}

Note get_note(Decoder& in) {
  Note note;
  note.stamp = in.get_time();
  note.caused = in.get_time();
  note.code = in.get_text();
  note.text = in.get_text();
  return note;
}

}  // namespace

std::uint8_t encode(const Record& record, std::vector<unsigned char>& out) {
  Encoder encoder(out);
  return std::visit([&](const auto& r) -> std::uint8_t { return put(encoder, r); }, record);
}

bool is_plausible(std::uint8_t kind, std::size_t size) {
  switch (kind) {
    case kHeader:
      return size == kHeaderBytes;
    case kStep:
      return size == kStepBytes;
    case kBelief:
      return size == kBeliefBytes;
    case kLinkStats:
      return size >= kLeastStatsBytes && size <= kMostStatsBytes;
    case kNote:
      return size >= kLeastNoteBytes && size <= kMostNoteBytes;
    default:
      return false;
  }
}

std::optional<Record> decode(std::uint8_t kind, std::span<const unsigned char> payload) {
  Decoder in(payload);
  Record record;
  switch (kind) {
    case kHeader:
      record = get_header(in);
      break;
    case kStep:
      record = get_step(in);
      break;
    case kBelief:
      record = get_belief(in);
      break;
    case kLinkStats:
      record = get_link_stats(in);
      break;
    case kNote:
      record = get_note(in);
      break;
    default:
      return std::nullopt;
  }
  if (!in.finished()) return std::nullopt;
  return record;
}

}  // namespace swarm::blackbox
