// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "tests/conformance/receivers/receiver.hpp"

/// Messages that every receiver must refuse, and good ones to compare with.
namespace swarm::link::conformance {

inline constexpr UtcTime kNow{std::chrono::seconds(1'800'000'000)};
inline constexpr auto kHuge = std::numeric_limits<std::uint64_t>::max();

/// What the messages refer to: the receiver's present time, and the planner that it follows.
struct Basis {
  UtcTime now = kNow;
  std::uint64_t epoch = 1'799'999'900'000'000'000;  ///< 100 s before kNow
};

/// Stamps and ids of a time `seconds` after the basis' present time.
std::int64_t ns_after(int seconds);
std::uint64_t id_after(int seconds);

/// A good message of a topic (an index of AnyMessage) of the small mission. Of each topic, message
/// 2 is newer than message 1.
AnyMessage good(std::size_t topic, int n);

struct Case {
  std::string name;
  AnyMessage bad;
  RefusalReason reason;
  std::string only{};  ///< the one receiver that refuses it; empty: all that read the topic
};

/// All cases; the functions above refer to this basis from now on.
std::vector<Case> all_cases(const Basis& basis = {});

}  // namespace swarm::link::conformance
