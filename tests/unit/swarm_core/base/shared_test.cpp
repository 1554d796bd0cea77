// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/base/shared.hpp"

#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace swarm {
namespace {

struct Inner {
  int number = 7;
};

/// Counts how many of it exist.
struct Outer {
  explicit Outer(int* counter) : alive(counter) { ++*alive; }
  Outer(Outer&& other) noexcept : alive(other.alive), inner(other.inner), name(other.name) {
    ++*alive;
  }
  Outer(const Outer&) = delete;
  Outer& operator=(const Outer&) = delete;
  ~Outer() { --*alive; }
  int* alive;
  Inner inner{};
  std::string name = "outer";
};

TEST(Shared, HasOneObjectForAllItsCopies) {
  const Shared<std::string> a(std::string("a text too long for a small string buffer"));
  const Shared<std::string> b = a;

  EXPECT_EQ(&*a, &*b);
  EXPECT_EQ(*b, "a text too long for a small string buffer");
  EXPECT_EQ(b->size(), 41U);
}

TEST(Shared, OfEqualValuesIsNotOneObject) {
  const Shared<std::string> a(std::string("x")), b(std::string("x"));

  EXPECT_NE(&*a, &*b);
}

TEST(Shared, HasOneDefaultForTheWholeProcess) {
  const Shared<Inner> a;
  const Inner* elsewhere = nullptr;
  std::thread([&] { elsewhere = &*Shared<Inner>(); }).join();

  EXPECT_EQ(a->number, 7);
  EXPECT_EQ(&*a, elsewhere);
}

TEST(Shared, EndsWithItsLastOwner) {
  int alive = 0;
  std::optional<Shared<Outer>> first{Outer(&alive)};
  std::vector<Shared<Outer>> copies(5, *first);
  EXPECT_EQ(alive, 1);
  first.reset();
  copies.resize(1, copies.front());
  EXPECT_EQ(alive, 1);
  copies.clear();

  EXPECT_EQ(alive, 0);
}

TEST(Shared, KeepsTheWholeAliveForAPart) {
  int alive = 0;
  std::optional<Shared<Outer>> whole{Outer(&alive)};
  const Outer* object = &**whole;
  std::optional<Shared<std::string>> part{whole->part(&Outer::name)};

  EXPECT_EQ(&**part, &object->name);
  whole.reset();
  EXPECT_EQ(alive, 1);
  EXPECT_EQ(**part, "outer");
  part.reset();
  EXPECT_EQ(alive, 0);
}

}  // namespace
}  // namespace swarm
