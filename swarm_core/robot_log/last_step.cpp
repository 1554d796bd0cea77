// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/robot_log/last_step.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

namespace swarm::robot_log {
namespace {

constexpr double kMost = 1e6;  // as in states: [m], [m/s]

/// Reads `text` from its begin, and shortens it.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  bool take(std::string_view expected) {
    if (!text_.starts_with(expected)) return false;
    text_.remove_prefix(expected.size());
    return true;
  }
  template <class Number>
  bool number(Number& value) {
    const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
    if (error != std::errc{}) return false;
    text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
    return true;
  }
  bool vector(Vec2& v) {
    return take("(") && number(v.x()) && take(", ") && number(v.y()) && take(")") &&
           std::abs(v.x()) <= kMost && std::abs(v.y()) <= kMost;
  }
  bool is_at_end() const { return text_.empty(); }

 private:
  std::string_view text_;
};

}  // namespace

std::string to_text(const LastStep& step) {
  return fmt::format("robot {}: at {} ns at ({:.4f}, {:.4f}) m with ({:.4f}, {:.4f}) m/s",
                     step.robot.value(), step.stamp.time_since_epoch().count(), step.position_m.x(),
                     step.position_m.y(), step.velocity_mps.x(), step.velocity_mps.y());
}

std::optional<LastStep> parse_last_step(std::string_view text) {
  Reader reader(text);
  std::uint32_t robot = 0;
  std::int64_t stamp_ns = 0;
  LastStep step;
  const bool is_whole = reader.take("robot ") && reader.number(robot) && reader.take(": at ") &&
                        reader.number(stamp_ns) && reader.take(" ns at ") &&
                        reader.vector(step.position_m) && reader.take(" m with ") &&
                        reader.vector(step.velocity_mps) && reader.take(" m/s") &&
                        reader.is_at_end();
  if (!is_whole) return std::nullopt;
  step.robot = RobotId(robot);
  step.stamp = UtcTime(Duration(stamp_ns));
  return step;
}

}  // namespace swarm::robot_log
