// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/cdr/lengths_fit.hpp"

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

namespace swarm::link::cdr {

using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;
using Payload = std::span<std::byte>;

namespace {

// Bytes an element takes at least, from the IDL.
constexpr std::size_t kPlanNodeBytes = 56;
constexpr std::size_t kPlanLegBytes = 16;
constexpr std::size_t kPlanEntryBytes = 4;
constexpr std::size_t kSceneObstacleBytes = 68;
constexpr std::size_t kPointBytes = 16;
constexpr std::size_t kGoalComponentBytes = 48;
constexpr std::size_t kRobotStateBytes = 49;
constexpr std::size_t kRobotStatusBytes = 67;
constexpr std::size_t kHistogramBinBytes = 6;

class Walker {
 public:
  explicit Walker(Payload payload)
      : buffer_(reinterpret_cast<char*>(payload.data()), payload.size()),
        cdr_(buffer_, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR),
        size_(payload.size()) {
    cdr_.read_encapsulation();
  }

  template <class... Fields>
  void skip() {
    (skip_one<Fields>(), ...);
  }

  template <class Field>
  void skip_times(std::uint32_t times) {
    for (std::uint32_t i = 0; i < times; ++i) skip_one<Field>();
  }

  std::uint32_t length() {
    std::uint32_t n = 0;
    cdr_ >> n;
    return n;
  }

  bool fits(std::uint32_t elements, std::size_t bytes_each) const {
    return elements <= (size_ - cdr_.getSerializedDataLength()) / bytes_each;
  }

 private:
  template <class Field>
  void skip_one() {
    Field field{};
    cdr_ >> field;
  }

  FastBuffer buffer_;
  Cdr cdr_;
  std::size_t size_;
};

}  // namespace

template <>
bool lengths_fit<wire::FlowPlan>(Payload payload) {
  Walker walker(payload);
  walker.skip<std::uint16_t, std::uint32_t, std::uint64_t, std::uint64_t, std::int64_t, double>();
  const auto nodes = walker.length();
  if (!walker.fits(nodes, kPlanNodeBytes)) return false;
  walker.skip_times<double>(nodes * static_cast<std::uint32_t>(kPlanNodeBytes / sizeof(double)));
  const auto legs = walker.length();
  if (!walker.fits(legs, kPlanLegBytes)) return false;
  for (std::uint32_t i = 0; i < legs; ++i) walker.skip<std::uint32_t, std::uint32_t, double>();
  return walker.fits(walker.length(), kPlanEntryBytes);
}

template <>
bool lengths_fit<wire::Scene>(Payload payload) {
  Walker walker(payload);
  walker.skip<std::uint16_t, std::uint64_t, double, std::uint32_t>();
  const auto removed = walker.length();
  if (!walker.fits(removed, sizeof(std::uint32_t))) return false;
  walker.skip_times<std::uint32_t>(removed);
  const auto obstacles = walker.length();
  if (!walker.fits(obstacles, kSceneObstacleBytes)) return false;
  for (std::uint32_t i = 0; i < obstacles; ++i) {
    walker.skip<std::uint32_t, std::uint32_t, std::uint32_t, double, double, double, double, double,
                std::int64_t, std::int64_t>();
  }
  const auto vertices = walker.length();
  if (!walker.fits(vertices, kPointBytes)) return false;
  walker.skip_times<double>(2 * vertices);
  return walker.fits(walker.length(), kGoalComponentBytes);
}

template <>
bool lengths_fit<wire::CellStates>(Payload payload) {
  Walker walker(payload);
  walker.skip<std::uint16_t, std::int32_t, std::int32_t>();
  return walker.fits(walker.length(), kRobotStateBytes);
}

template <>
bool lengths_fit<wire::Status>(Payload payload) {
  Walker walker(payload);
  walker.skip<std::uint32_t, std::uint16_t, std::uint32_t, std::uint32_t, std::uint64_t,
              std::uint64_t, std::int64_t, double>();
  const auto robots = walker.length();
  if (!walker.fits(robots, kRobotStatusBytes)) return false;
  for (std::uint32_t i = 0; i < robots; ++i) {
    walker.skip<std::uint32_t, std::uint8_t, bool, bool, double, double, double, double, double,
                std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>();
  }
  const auto refused = walker.length();
  if (!walker.fits(refused, sizeof(std::uint32_t))) return false;
  walker.skip_times<std::uint32_t>(refused);
  return walker.fits(walker.length(), kHistogramBinBytes);
}

// Without sequences; strings are checked by the decoder itself.
template <>
bool lengths_fit<wire::Heartbeat>(Payload) {
  return true;
}
template <>
bool lengths_fit<wire::Command>(Payload) {
  return true;
}
template <>
bool lengths_fit<wire::Event>(Payload) {
  return true;
}

}  // namespace swarm::link::cdr
