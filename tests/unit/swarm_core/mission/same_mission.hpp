// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <type_traits>
#include <variant>

#include <gtest/gtest.h>

#include "swarm_core/mission_file/scene_change_file.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/mission/section_key.hpp"

/// Expectations that two missions, or parts of them, are the same: for tests that write and read.
namespace swarm {

inline void expect_same(const Mixture& a, const Mixture& b) {
  ASSERT_EQ(a.components().size(), b.components().size());
  for (std::size_t i = 0; i < a.components().size(); ++i) {
    const auto& [weight, gaussian] = a.components()[i];
    // Weights are divided by their sum once more: one rounding.
    EXPECT_NEAR(weight, b.components()[i].weight, 1e-15);
    EXPECT_EQ(gaussian.mean_m(), b.components()[i].gaussian.mean_m());
    EXPECT_EQ(gaussian.covariance_m2(), b.components()[i].gaussian.covariance_m2());
  }
}

inline void expect_same(const World& a, const World& b) {
  EXPECT_EQ(a.bounds_m().min_m, b.bounds_m().min_m);
  EXPECT_EQ(a.bounds_m().max_m, b.bounds_m().max_m);
  ASSERT_EQ(a.obstacles().size(), b.obstacles().size());
  for (std::size_t i = 0; i < a.obstacles().size(); ++i) {
    ASSERT_EQ(a.obstacles()[i].index(), b.obstacles()[i].index());
    if (const auto* circle = std::get_if<Circle>(&a.obstacles()[i])) {
      EXPECT_EQ(circle->center_m, std::get<Circle>(b.obstacles()[i]).center_m);
      EXPECT_EQ(circle->radius_m, std::get<Circle>(b.obstacles()[i]).radius_m);
    } else {
      EXPECT_EQ(std::get<Polygon>(a.obstacles()[i]).vertices_m(),
                std::get<Polygon>(b.obstacles()[i]).vertices_m());
    }
  }
}

/// Converts to anything: counts the members of an aggregate.
struct Anything {
  template <class T>
  operator T() const;  // NOLINT: implicit on purpose
};

template <class Aggregate, class... Members>
constexpr std::size_t members_of() {
  if constexpr (requires { Aggregate{Members{}..., Anything{}}; }) {
    return members_of<Aggregate, Members..., Anything>();
  } else {
    return sizeof...(Members);
  }
}

template <class Section, std::size_t N>
void expect_same(const Section& a, const Section& b,
                 const std::array<SectionKey<Section>, N>& fields) {
  // The tables are all that reader and writer know: a member without a row would be lost.
  // Beside the table: texts, what may be automatic, options of components, and of robots the body
  // and the groups.
  constexpr std::size_t kOthers = std::is_same_v<Section, PlannerSpec>   ? 3
                                  : std::is_same_v<Section, RobotsSpec>  ? 2
                                  : std::is_same_v<Section, ControlSpec> ? 3
                                  : std::is_same_v<Section, BodySpec>    ? 3
                                                                         : 0;
  if constexpr (std::is_same_v<Section, CriteriaSpec>) {
    static_assert(sizeof(Section) == N * sizeof(std::optional<double>));
  } else {
    static_assert(members_of<Section>() == N + kOthers);
  }
  for (const auto& field : fields) {
    std::visit([&](auto member) { EXPECT_EQ(a.*member, b.*member) << field.key; }, field.member);
  }
}

inline void expect_same(const Mission& a, const Mission& b) {
  EXPECT_EQ(a.name, b.name);
  expect_same(a.world, b.world);
  expect_same(a.start, b.start);
  expect_same(a.goal, b.goal);
  EXPECT_EQ(a.planner.method, b.planner.method);
  EXPECT_EQ(a.planner.options, b.planner.options);
  EXPECT_EQ(a.planner.density_cap_per_m2, b.planner.density_cap_per_m2);
  expect_same(a.robots, b.robots, kRobotsKeys);
  const auto expect_same_body = [](const BodySpec& one, const BodySpec& other) {
    EXPECT_EQ(one.model, other.model);
    EXPECT_EQ(one.lag_s, other.lag_s);
    EXPECT_EQ(one.options, other.options);
    expect_same(one, other, kBodyKeys);
  };
  expect_same_body(a.robots, b.robots);
  ASSERT_EQ(a.robots.groups.size(), b.robots.groups.size());
  for (std::size_t i = 0; i < a.robots.groups.size(); ++i) {
    EXPECT_EQ(a.robots.groups[i].count, b.robots.groups[i].count);
    expect_same_body(a.robots.groups[i], b.robots.groups[i]);
  }
  EXPECT_EQ(a.control.method, b.control.method);
  EXPECT_EQ(a.control.options, b.control.options);
  EXPECT_EQ(a.control.shape_tolerance_m2, b.control.shape_tolerance_m2);
  expect_same(a.planner, b.planner, kPlannerKeys);
  expect_same(a.control, b.control, kControlKeys);
  expect_same(a.safety, b.safety, kSafetyKeys);
  expect_same(a.link, b.link, kLinkKeys);
  expect_same(a.timing, b.timing, kTimingKeys);
  expect_same(a.plan_clock, b.plan_clock, kPlanClockKeys);
  expect_same(a.launcher, b.launcher, kLauncherKeys);
  expect_same(a.criteria, b.criteria, kCriteriaKeys);
  ASSERT_EQ(a.script.size(), b.script.size());
  for (std::size_t i = 0; i < a.script.size(); ++i) {
    const ScriptEvent &event = a.script[i], &same = b.script[i];
    EXPECT_EQ(event.at_s, same.at_s);
    ASSERT_EQ(event.action.index(), same.action.index());
    if (const auto* kind = std::get_if<CommandKind>(&a.script[i].action)) {
      EXPECT_EQ(*kind, std::get<CommandKind>(b.script[i].action));
    } else {
      // Equal keys mean equal changes, because keys are written with all digits.
      const auto& change = std::get<SceneChange>(a.script[i].action);
      const auto& other = std::get<SceneChange>(b.script[i].action);
      EXPECT_EQ(name_of(change), name_of(other));
      EXPECT_EQ(keys_of(change), keys_of(other));
    }
  }
}

}  // namespace swarm
