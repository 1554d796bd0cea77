// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/roles/domain_lock.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

namespace swarm::link {
namespace {

constexpr std::uint32_t kDomains = 230;  // ports of domain 232 end at 65535
// 250 ports per domain, two per participant, less those that the standard reserves.
constexpr std::uint32_t kPortPairsPerDomain = 120;

/// Opens and locks the lock file of one domain; -1 if another process holds it.
int lock_domain(std::uint32_t domain) {
  const auto file =
      std::filesystem::temp_directory_path() / fmt::format("swarmflow-domain-{}.lock", domain);
  const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (fd < 0) return -1;
  if (::flock(fd, LOCK_EX | LOCK_NB) == 0) return fd;
  ::close(fd);
  return -1;
}

}  // namespace

DomainLock::DomainLock(DomainLock&& other) noexcept
    : domain_(other.domain_), files_(std::exchange(other.files_, {})) {}

DomainLock::~DomainLock() {
  for (const int fd : files_) ::close(fd);
}

// Tries blocks of consecutive domains from the first candidate on. A block that cannot be locked
// completely is released by the destructor of `lock`.
Result<DomainLock> DomainLock::take(int wanted, std::uint32_t participants) {
  const std::uint32_t block = participants / kPortPairsPerDomain + 1;
  const std::uint32_t first = wanted < 0 ? 1 : static_cast<std::uint32_t>(wanted);
  const std::uint32_t last = wanted < 0 ? kDomains - block : first;
  if (first + block > kDomains) {
    return fail(
        ErrorCode::kBadInput,
        fmt::format("--domain {}: {} participants need the domains {} to {}, the last is {}", first,
                    participants, first, first + block - 1, kDomains - 1));
  }
  for (std::uint32_t domain = first; domain <= last; ++domain) {
    DomainLock lock;
    lock.domain_ = domain;
    for (std::uint32_t d = domain; d < domain + block; ++d) {
      const int fd = lock_domain(d);
      if (fd < 0) break;
      lock.files_.push_back(fd);
    }
    if (lock.files_.size() == block) return lock;
  }
  return fail(ErrorCode::kEnvironment,
              wanted < 0 ? "no free DDS domain: too many runs on this machine"
                         : fmt::format("DDS domain {} (of {} in a row) is in use by another run",
                                       wanted, block));
}

}  // namespace swarm::link
