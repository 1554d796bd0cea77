// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/robot/control_slot.hpp"

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

/// A method that counts its instances; `Room` decides whether one fits into a slot.
template <std::size_t Room>
class Counted final : public ControlMethod {
 public:
  Counted(int& alive, double speed_mps) : alive_(&alive), speed_mps_(speed_mps) { ++*alive_; }
  Counted(Counted&& other) noexcept : alive_(other.alive_), speed_mps_(other.speed_mps_) {
    ++*alive_;
  }
  ~Counted() override { --*alive_; }
  void begin(const Route&, const World&) override {}
  bool has_arrived(const ControlView&) override { return false; }
  Vec2 desired_velocity(const ControlView&, bool, Rng&) override { return {speed_mps_, 0}; }
  Vec2 hold(const ControlView&) override { return {speed_mps_, 0}; }
  std::uint32_t goal(const Vec2&) const override { return 0; }
  double remaining_m() const override { return speed_mps_; }
  std::uint32_t escapes() const override { return 0; }

 private:
  int* alive_;
  double speed_mps_;
  std::array<std::byte, Room> room_{};
};

template <class Method>
class ControlSlotOf : public testing::Test {};
using Sizes = testing::Types<Counted<8>, Counted<4096>>;
TYPED_TEST_SUITE(ControlSlotOf, Sizes);

TYPED_TEST(ControlSlotOf, KeepsItsMethodWhereverItIsMoved) {
  int alive = 0;
  {
    std::vector<ControlSlot> slots;
    for (int i = 0; i < 20; ++i) slots.push_back(ControlSlot::of<TypeParam>(alive, 1.0 * i));
    EXPECT_EQ(alive, 20);
    for (int i = 0; i < 20; ++i) EXPECT_EQ(slots[static_cast<std::size_t>(i)]->remaining_m(), i);
    slots.front() = std::move(slots.back());
    EXPECT_EQ(slots.front()->remaining_m(), 19);
    EXPECT_FALSE(slots.back());
    EXPECT_EQ(alive, 19);
  }
  EXPECT_EQ(alive, 0);
}

TEST(ControlSlot, TakesAMethodFromTheHeap) {
  int alive = 0;
  {
    const ControlSlot slot = ControlSlot::of(std::make_unique<Counted<8>>(alive, 3.0));
    EXPECT_EQ(slot->remaining_m(), 3.0);
    EXPECT_EQ(alive, 1);
  }
  EXPECT_EQ(alive, 0);
}

}  // namespace
}  // namespace swarm::agent
