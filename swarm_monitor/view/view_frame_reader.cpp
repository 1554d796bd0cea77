// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/view_frame_reader.hpp"

#include <cstring>

namespace swarm::monitor {
namespace {

/// Sizes of header, robot and component in bytes, as ViewFrameEncoder writes them.
constexpr std::size_t kHead = 24;
constexpr std::size_t kRobot = 16;
constexpr std::size_t kComponent = 24;
constexpr std::size_t kFlags = 14;  // in a robot

template <class T>
T at(std::span<const std::byte> bytes, std::size_t offset) {
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

}  // namespace

/// Sizes are computed in 64 bits, so that large counts in a damaged header cannot overflow the
/// check.
std::optional<ViewFrame> read_view_frame(std::span<const std::byte> bytes, const Vec2& origin_m) {
  if (bytes.size() < kHead || std::memcmp(bytes.data(), "SWF1", 4) != 0) return std::nullopt;
  const std::uint64_t robots = at<std::uint32_t>(bytes, 4);
  const std::uint64_t components = at<std::uint32_t>(bytes, 20);
  if (bytes.size() - kHead < robots * kRobot + components * kComponent) return std::nullopt;

  ViewFrame view_frame;
  view_frame.robots.reserve(robots);
  bytes = bytes.subspan(kHead);
  for (std::uint64_t i = 0; i < robots; ++i, bytes = bytes.subspan(kRobot)) {
    view_frame.robots.push_back({.x_m = origin_m.x() + at<float>(bytes, 0),
                                 .y_m = origin_m.y() + at<float>(bytes, 4),
                                 .heading = at<float>(bytes, 8),
                                 .was_received = (at<std::uint8_t>(bytes, kFlags) & 1U) != 0});
  }
  view_frame.mixture.reserve(components);
  for (std::uint64_t i = 0; i < components; ++i, bytes = bytes.subspan(kComponent)) {
    view_frame.mixture.push_back({.x_m = origin_m.x() + at<float>(bytes, 0),
                                  .y_m = origin_m.y() + at<float>(bytes, 4),
                                  .xx = at<float>(bytes, 8),
                                  .xy = at<float>(bytes, 12),
                                  .yy = at<float>(bytes, 16),
                                  .weight = at<float>(bytes, 20)});
  }
  return view_frame;
}

}  // namespace swarm::monitor
