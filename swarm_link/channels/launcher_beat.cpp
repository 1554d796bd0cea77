// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/channels/launcher_beat.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace swarm::link {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kFixedBytes = 32;
constexpr std::uint32_t kListsAll = 1;
constexpr std::uint32_t kListsAllLate = 2;
static_assert(sizeof(RobotRange) == 8 && sizeof(LateRobot) == 24);

template <class Number>
void put(std::vector<std::byte>& out, Number number) {
  const std::size_t at = out.size();
  out.resize(at + sizeof number);
  std::memcpy(out.data() + at, &number, sizeof number);
}

template <class Number>
Number get(std::span<const std::byte>& bytes) {
  Number number;
  std::memcpy(&number, bytes.data(), sizeof number);
  bytes = bytes.subspan(sizeof number);
  return number;
}

}  // namespace

void set_silent(LauncherBeat& beat, std::span<const RobotId> robots) {
  beat.ranges = 0;
  beat.lists_all = true;
  for (std::size_t i = 0; i < robots.size();) {
    if (beat.ranges == LauncherBeat::kMaxRanges) {
      beat.lists_all = false;
      return;
    }
    std::uint32_t count = 1;
    while (i + count < robots.size() && robots[i + count].value() == robots[i].value() + count) {
      ++count;
    }
    beat.range[beat.ranges++] = {robots[i].value(), count};
    i += count;
  }
}

void set_late(LauncherBeat& beat, std::span<const LateRobot> robots) {
  beat.lists_all_late = robots.size() <= LauncherBeat::kMaxLate;
  beat.late_robots = static_cast<std::uint32_t>(std::min(robots.size(), LauncherBeat::kMaxLate));
  std::copy_n(robots.begin(), beat.late_robots, beat.late_robot.begin());
}

void encode(const LauncherBeat& beat, std::vector<std::byte>& out) {
  out.clear();
  put(out, beat.run);
  put(out, beat.sequence);
  put(out, beat.sent_ns);
  put(out, (beat.lists_all ? kListsAll : 0U) | (beat.lists_all_late ? kListsAllLate : 0U));
  put(out, beat.ranges);
  for (const RobotRange& range : beat.silent()) {
    put(out, range.first);
    put(out, range.count);
  }
  for (const LateRobot& late : beat.late()) {
    put(out, late.robot);
    put(out, late.age_ms);
    put(out, late.x_m);
    put(out, late.y_m);
  }
}

bool decode(std::span<const std::byte> bytes, LauncherBeat& beat) {
  if (bytes.size() < kFixedBytes) return false;
  const auto run = get<std::uint64_t>(bytes);
  const auto sequence = get<std::uint64_t>(bytes);
  const auto sent_ns = get<std::int64_t>(bytes);
  const auto flags = get<std::uint32_t>(bytes);
  const auto ranges = get<std::uint32_t>(bytes);
  if (flags > (kListsAll | kListsAllLate) || ranges > LauncherBeat::kMaxRanges) return false;
  if (bytes.size() < ranges * sizeof(RobotRange)) return false;
  const std::size_t late_bytes = bytes.size() - ranges * sizeof(RobotRange);
  if (late_bytes % sizeof(LateRobot) != 0) return false;
  if (late_bytes / sizeof(LateRobot) > LauncherBeat::kMaxLate) return false;
  beat.run = run;
  beat.sequence = sequence;
  beat.sent_ns = sent_ns;
  beat.lists_all = (flags & kListsAll) != 0;
  beat.lists_all_late = (flags & kListsAllLate) != 0;
  for (beat.ranges = 0; beat.ranges < ranges; ++beat.ranges) {
    RobotRange& range = beat.range[beat.ranges];
    range.first = get<std::uint32_t>(bytes);
    range.count = get<std::uint32_t>(bytes);
  }
  for (beat.late_robots = 0; !bytes.empty(); ++beat.late_robots) {
    LateRobot& late = beat.late_robot[beat.late_robots];
    late.robot = get<std::uint32_t>(bytes);
    late.age_ms = get<std::uint32_t>(bytes);
    late.x_m = get<double>(bytes);
    late.y_m = get<double>(bytes);
  }
  return true;
}

}  // namespace swarm::link
