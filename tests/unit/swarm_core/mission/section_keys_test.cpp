// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The tables of the mission file's scalar keys, each row against its section's defaults.
#include <optional>
#include <set>
#include <span>
#include <string>
#include <type_traits>
#include <variant>

#include <gtest/gtest.h>

#include "swarmflow/mission/mission.hpp"

namespace swarm {
namespace {

/// The number that a key has without being set, the index of a choice; empty for an optional
/// number.
template <class Section>
std::optional<double> default_of(const SectionKey<Section>& key) {
  const Section section{};
  return std::visit(
      [&](auto member) -> std::optional<double> {
        if constexpr (std::is_same_v<decltype(member), LauncherLoss Section::*>) {
          return static_cast<double>(section.*member);
        } else {
          return section.*member;
        }
      },
      key.member);
}

template <class Section>
void expect_sound(std::span<const SectionKey<Section>> keys) {
  std::set<std::string> names;
  for (const SectionKey<Section>& key : keys) {
    const std::string name(key.key);
    EXPECT_TRUE(names.insert(name).second) << name << " twice";
    EXPECT_FALSE(key.doc.empty()) << name;
    EXPECT_EQ(key.doc.find('\n'), std::string_view::npos) << name;
    EXPECT_LT(key.range.low, key.range.high) << name;
    if (const auto value = default_of(key)) {
      EXPECT_TRUE(key.range.contains(*value)) << name << " is " << *value << " by default";
    }
  }
}

// Two rows that set the same member would let one key overwrite another.
template <class Section>
void expect_distinct_members(std::span<const SectionKey<Section>> keys) {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_FALSE(keys[i].member == keys[j].member) << keys[i].key << " and " << keys[j].key;
    }
  }
}

template <class Section>
void expect_table(std::span<const SectionKey<Section>> keys) {
  ASSERT_FALSE(keys.empty());
  expect_sound(keys);
  expect_distinct_members(keys);
}

TEST(SectionKeys, HaveDefaultsInTheirRangesAndMembersOfTheirOwn) {
  expect_table<RobotsSpec>(kRobotsKeys);
  expect_table<BodySpec>(kBodyKeys);
  expect_table<PlannerSpec>(kPlannerKeys);
  expect_table<ControlSpec>(kControlKeys);
  expect_table<SafetySpec>(kSafetyKeys);
  expect_table<LinkSpec>(kLinkKeys);
  expect_table<TimingSpec>(kTimingKeys);
  expect_table<PlanClockSpec>(kPlanClockKeys);
  expect_table<LauncherSpec>(kLauncherKeys);
  expect_table<CriteriaSpec>(kCriteriaKeys);
}

}  // namespace
}  // namespace swarm
