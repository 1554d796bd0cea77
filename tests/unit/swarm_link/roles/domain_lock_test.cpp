// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/roles/domain_lock.hpp"

#include <array>
#include <csignal>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace swarm::link {
namespace {

/// Locks of a name of its own on a machine whose ports are free, so that runs on this machine do
/// not matter.
struct DomainLockTest : testing::Test {
  Result<DomainLock> take(int wanted, std::uint32_t participants, std::uint32_t fixed = 0) const {
    return DomainLock::take(wanted, {.participants = participants, .fixed = fixed}, host());
  }
  bool is_free(int domain) const { return take(domain, 1).has_value(); }
  DomainHost host() const {
    return {.name = name, .is_free = [this](std::uint16_t port, bool shared) {
              return taken.count(port) == 0 && (shared || in_groups.count(port) == 0);
            }};
  }

  const std::string name = "swarmflow-test-" + std::to_string(::getpid()) + "-";
  std::set<std::uint16_t> taken;      ///< ports of other programs
  std::set<std::uint16_t> in_groups;  ///< ports that other programs share
};

TEST_F(DomainLockTest, TakesTheFirstFreeDomainAndReleasesItAtItsEnd) {
  const auto first = take(-1, 10);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->domain(), 1U);
  {
    const auto second = take(-1, 10);
    ASSERT_TRUE(second);
    EXPECT_EQ(second->domain(), 2U);
  }
  EXPECT_EQ(take(-1, 10).value().domain(), 2U);
}

TEST_F(DomainLockTest, RefusesADomainThatIsInUse) {
  const auto lock = take(7, 10);
  ASSERT_TRUE(lock);

  const auto again = take(7, 10);

  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::kEnvironment);
  EXPECT_EQ(again.error().message, "DDS domain 7 (of 1 in a row) is in use by another run");
  EXPECT_TRUE(is_free(8));
}

TEST_F(DomainLockTest, ReservesTheDomainsWhosePortsARunNeeds) {
  const auto lock = take(10, 500);  // 120 to a domain: 10 to 14
  ASSERT_TRUE(lock);
  for (int domain = 8; domain <= 16; ++domain) {
    EXPECT_EQ(is_free(domain), domain < 10 || domain > 14) << domain;
  }
}

TEST_F(DomainLockTest, ReleasesABlockThatItCannotHaveAsAWhole) {
  const auto lock = take(21, 1);
  ASSERT_TRUE(lock);

  EXPECT_FALSE(take(19, 300));  // 19 to 21

  EXPECT_TRUE(is_free(19));
  EXPECT_TRUE(is_free(20));
}

TEST_F(DomainLockTest, LooksForABlockBetweenDomainsInUse) {
  const auto in_the_middle = take(3, 1);
  ASSERT_TRUE(in_the_middle);
  EXPECT_EQ(take(-1, 300).value().domain(), 4U);
  EXPECT_EQ(take(-1, 130).value().domain(), 1U);
}

TEST_F(DomainLockTest, RefusesDomainsWhosePortsDoNotExist) {
  EXPECT_TRUE(is_free(0));
  EXPECT_TRUE(is_free(229));
  const auto beyond = take(230, 1);
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(beyond.error().message,
            "--domain 230: 1 participants need the domains 230 to 230, the last is 229");
  EXPECT_EQ(take(228, 300).error().message,
            "--domain 228: 300 participants need the domains 228 to 230, the last is 229");
  EXPECT_FALSE(take(-1, 4'000'000'000U)) << "more than all domains have";
}

TEST_F(DomainLockTest, FailsWhenNoDomainIsFree) {
  const auto all = take(1, 229 * 120 - 1);
  ASSERT_TRUE(all) << all.error().message;

  const auto one_more = take(-1, 1);

  ASSERT_FALSE(one_more);
  EXPECT_EQ(one_more.error().message,
            "no free DDS domain: too many runs or other programs on this machine");
}

TEST_F(DomainLockTest, KeepsTheDomainWhenMoved) {
  std::optional<DomainLock> from(take(5, 1).value());
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
    const auto lock = take(9, 1);
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

// Participant i of domain d has the ports 7410 + 250 d + 2 i and the one after it.
TEST_F(DomainLockTest, LooksForADomainWhosePortsAreAllFree) {
  taken = {7660 + 2 * 9 + 1};  // domain 1, data port of participant 9
  EXPECT_EQ(take(-1, 9).value().domain(), 1U) << "no participant needs that port";
  EXPECT_EQ(take(-1, 10).value().domain(), 2U);
  taken = {7660, 7910};
  EXPECT_EQ(take(-1, 1).value().domain(), 3U);
}

TEST_F(DomainLockTest, LooksForADomainInWhichNoOtherProgramReceivesGroups) {
  in_groups = {7650, 7901};  // discovery of domain 1, user multicast of domain 2
  EXPECT_EQ(take(-1, 1).value().domain(), 3U);
}

TEST_F(DomainLockTest, ReleasesADomainWhosePortsAreTaken) {
  taken = {7660};
  ASSERT_TRUE(take(-1, 1));
  taken.clear();
  EXPECT_TRUE(is_free(1));
}

TEST_F(DomainLockTest, RefusesAChosenDomainOnlyForPortsThatCannotBeReplaced) {
  taken = {7660 + 2 * 5};
  EXPECT_TRUE(take(1, 20, 5)) << "the others skip it";

  const auto refused = take(1, 20, 6);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kEnvironment);
  EXPECT_EQ(refused.error().message,
            "DDS domain 1: another program has its UDP port 7670; end it, choose another domain, "
            "or leave out --domain to get a free one");
}

TEST_F(DomainLockTest, SharesTheGroupsOfAChosenDomain) {
  in_groups = {7650, 7651};
  EXPECT_TRUE(take(1, 20, 6));
  taken = {7651};
  EXPECT_FALSE(take(1, 20, 0)) << "groups need it, whatever the participants do";
}

// A socket of the kernel's choice, in whose domain a participant would be.
TEST_F(DomainLockTest, AsksTheKernelForPorts) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  int domain = 220;  // high ones are rarely used
  for (;; --domain) {
    ASSERT_GT(domain, 100) << "all ports are in use";
    address.sin_port = htons(static_cast<std::uint16_t>(7410 + 250 * domain));
    if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) break;
  }
  DomainHost real = host();
  real.is_free = nullptr;

  const auto lock = DomainLock::take(domain, {.participants = 1, .fixed = 1}, real);

  ASSERT_FALSE(lock);
  EXPECT_NE(lock.error().message.find(std::to_string(7410 + 250 * domain)), std::string::npos)
      << lock.error().message;
  ::close(fd);
}

}  // namespace
}  // namespace swarm::link
