// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/roles/domain_lock.hpp"

#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace swarm::link {
namespace {

/// Lock files of its own, so that runs on this machine do not matter.
struct DomainLockTest : testing::Test {
  DomainLockTest() {
    if (const char* before = std::getenv("TMPDIR")) before_ = before;
    std::string name = std::filesystem::temp_directory_path() / "domain_lock_XXXXXX";
    folder_ = ::mkdtemp(name.data());
    ::setenv("TMPDIR", folder_.c_str(), 1);
  }
  ~DomainLockTest() override {
    before_ ? ::setenv("TMPDIR", before_->c_str(), 1) : ::unsetenv("TMPDIR");
    std::filesystem::remove_all(folder_);
  }
  DomainLockTest(const DomainLockTest&) = delete;
  DomainLockTest& operator=(const DomainLockTest&) = delete;

  static bool is_free(int domain) { return DomainLock::take(domain, 1).has_value(); }

 private:
  std::optional<std::string> before_;
  std::string folder_;
};

TEST_F(DomainLockTest, TakesTheFirstFreeDomainAndReleasesItAtItsEnd) {
  const auto first = DomainLock::take(-1, 10);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->domain(), 1U);
  {
    const auto second = DomainLock::take(-1, 10);
    ASSERT_TRUE(second);
    EXPECT_EQ(second->domain(), 2U);
  }
  EXPECT_EQ(DomainLock::take(-1, 10).value().domain(), 2U);
}

TEST_F(DomainLockTest, RefusesADomainThatIsInUse) {
  const auto lock = DomainLock::take(7, 10);
  ASSERT_TRUE(lock);

  const auto again = DomainLock::take(7, 10);

  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::kEnvironment);
  EXPECT_EQ(again.error().message, "DDS domain 7 (of 1 in a row) is in use by another run");
  EXPECT_TRUE(is_free(8));
}

TEST_F(DomainLockTest, ReservesTheDomainsWhosePortsARunNeeds) {
  const auto lock = DomainLock::take(10, 500);  // 120 to a domain: 10 to 14
  ASSERT_TRUE(lock);
  for (int domain = 8; domain <= 16; ++domain) {
    EXPECT_EQ(is_free(domain), domain < 10 || domain > 14) << domain;
  }
}

TEST_F(DomainLockTest, ReleasesABlockThatItCannotHaveAsAWhole) {
  const auto lock = DomainLock::take(21, 1);
  ASSERT_TRUE(lock);

  EXPECT_FALSE(DomainLock::take(19, 300));  // 19 to 21

  EXPECT_TRUE(is_free(19));
  EXPECT_TRUE(is_free(20));
}

TEST_F(DomainLockTest, LooksForABlockBetweenDomainsInUse) {
  const auto in_the_middle = DomainLock::take(3, 1);
  ASSERT_TRUE(in_the_middle);
  EXPECT_EQ(DomainLock::take(-1, 300).value().domain(), 4U);
  EXPECT_EQ(DomainLock::take(-1, 130).value().domain(), 1U);
}

TEST_F(DomainLockTest, RefusesDomainsWhosePortsDoNotExist) {
  EXPECT_TRUE(is_free(0));
  EXPECT_TRUE(is_free(229));
  const auto beyond = DomainLock::take(230, 1);
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(beyond.error().message,
            "--domain 230: 1 participants need the domains 230 to 230, the last is 229");
  EXPECT_EQ(DomainLock::take(228, 300).error().message,
            "--domain 228: 300 participants need the domains 228 to 230, the last is 229");
  EXPECT_FALSE(DomainLock::take(-1, 4'000'000'000U)) << "more than all domains have";
}

TEST_F(DomainLockTest, FailsWhenNoDomainIsFree) {
  const auto all = DomainLock::take(1, 229 * 120 - 1);
  ASSERT_TRUE(all) << all.error().message;

  const auto one_more = DomainLock::take(-1, 1);

  ASSERT_FALSE(one_more);
  EXPECT_EQ(one_more.error().message, "no free DDS domain: too many runs on this machine");
}

TEST_F(DomainLockTest, KeepsTheDomainWhenMoved) {
  std::optional<DomainLock> from(DomainLock::take(5, 1).value());
  const DomainLock to = std::move(*from);
  from.reset();

  EXPECT_EQ(to.domain(), 5U);
  EXPECT_FALSE(is_free(5));
}

TEST_F(DomainLockTest, IsReleasedByTheKernelWhenItsProcessIsKilled) {
  std::array<int, 2> ready{};
  ASSERT_EQ(::pipe(ready.data()), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const auto lock = DomainLock::take(9, 1);
    const char answer = lock ? 'y' : 'n';
    if (::write(ready[1], &answer, 1) != 1) ::_exit(1);
    for (;;) ::pause();
  }
  char answer = 0;
  EXPECT_EQ(::read(ready[0], &answer, 1), 1);
  EXPECT_EQ(answer, 'y');
  EXPECT_FALSE(is_free(9)) << "while the process runs";

  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);

  EXPECT_TRUE(is_free(9));
  ::close(ready[0]);
  ::close(ready[1]);
}

}  // namespace
}  // namespace swarm::link
