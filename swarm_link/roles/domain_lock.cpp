// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/roles/domain_lock.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "swarm_core/base/foreign_settings.hpp"
#include "swarm_link/announcement_port.hpp"
#include "swarm_link/udp_socket.hpp"

namespace swarm::link {
namespace {

constexpr std::uint32_t kDomains = 230;  // ports of domain 232 end at 65535
// 250 ports per domain, two per participant, less those that the standard reserves.
constexpr std::uint32_t kPortPairsPerDomain = 120;
// Before the ports of participants come those of discovery by multicast and of user multicast.
constexpr std::uint16_t kReserved = 10;

/// Binds the abstract name of a domain; -1 if another process has it. A kernel that has no such
/// sockets gives none: then the ports alone decide.
std::optional<int> lock_domain(const std::string& prefix, std::uint32_t domain) {
  const std::string name = fmt::format("{}{}", prefix, domain);
  const int fd = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return std::nullopt;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::size_t length = std::min(name.size(), sizeof address.sun_path - 1);
  std::copy_n(name.begin(), length, address.sun_path + 1);  // the first byte is 0: abstract
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), size) == 0) return fd;
  const bool taken = errno == EADDRINUSE;
  ::close(fd);
  return taken ? std::optional(-1) : std::nullopt;
}

/// Binds the port on all interfaces. Other errors than a taken port are left to those who need it.
bool is_port_free(std::uint16_t port, bool shared) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  address.sin_port = htons(port);
  errno = 0;
  const int fd = open_receive_socket(address, 0, shared);
  if (fd < 0) return errno != EADDRINUSE;
  ::close(fd);
  return true;
}

/// The first port that the run would miss. All ports of a block are consecutive.
std::optional<std::uint16_t> missing_port(std::uint32_t domain, const DomainNeeds& needs,
                                          bool chosen, const DomainHost& host) {
  const std::uint16_t first = announcement_port(domain, 0);
  const std::uint32_t pairs = chosen ? needs.fixed : needs.participants;
  // Other DDS programs of a domain, and monitors of runs, have its multicast ports, which can be
  // shared. Our groups use the second one.
  const auto discovery = static_cast<std::uint16_t>(first - kReserved);
  const auto groups = static_cast<std::uint16_t>(discovery + 1);
  if (!chosen && !host.is_free(discovery, false)) return discovery;
  if (!host.is_free(groups, chosen)) return groups;
  for (std::uint32_t i = 0; i < 2 * pairs; ++i) {
    const std::uint32_t port = first + i;
    if (port > 0xFFFF) return std::nullopt;  // who needs it fails with a message of its own
    if (!host.is_free(static_cast<std::uint16_t>(port), false)) {
      return static_cast<std::uint16_t>(port);
    }
  }
  return std::nullopt;
}

/// The domain of the user's ROS programs, if one is set: a run must not be in it, as its drivers
/// may be.
std::optional<std::uint32_t> ros_domain_id() {
  const std::string text = foreign_setting("ROS_DOMAIN_ID");
  std::uint32_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  const bool is_number = !text.empty() && error == std::errc() && end == text.data() + text.size();
  return is_number ? std::optional(id) : std::nullopt;
}

}  // namespace

DomainLock::DomainLock(DomainLock&& other) noexcept
    : domain_(other.domain_), sockets_(std::exchange(other.sockets_, {})) {}

DomainLock::~DomainLock() {
  for (const int fd : sockets_) ::close(fd);
}

/// Reserves the domains of the block; false if another run has one of them.
bool DomainLock::reserve(std::uint32_t block, const std::string& name) {
  for (std::uint32_t d = domain_; d < domain_ + block; ++d) {
    const auto fd = lock_domain(name, d);
    if (!fd) continue;
    if (*fd < 0) return false;
    sockets_.push_back(*fd);
  }
  return true;
}

// Tries blocks of consecutive domains from the first candidate on. A block that cannot be had
// completely is released by the destructor of `lock`.
Result<DomainLock> DomainLock::take(int wanted, const DomainNeeds& needs, DomainHost host) {
  if (!host.is_free) host.is_free = is_port_free;
  const bool chosen = wanted >= 0;
  const std::uint32_t block = needs.participants / kPortPairsPerDomain + 1;
  const std::uint32_t first = chosen ? static_cast<std::uint32_t>(wanted) : 1;
  const std::uint32_t last = chosen ? first : kDomains - block;
  if (first + block > kDomains) {
    return fail(
        ErrorCode::kBadInput,
        fmt::format("--domain {}: {} participants need the domains {} to {}, the last is {}", first,
                    needs.participants, first, first + block - 1, kDomains - 1));
  }
  const std::optional<std::uint32_t> taken = ros_domain_id();
  for (std::uint32_t domain = first; domain <= last; ++domain) {
    if (!chosen && taken && domain <= *taken && *taken < domain + block) continue;
    DomainLock lock;
    lock.domain_ = domain;
    if (!lock.reserve(block, host.name)) continue;
    const auto missing = missing_port(domain, needs, chosen, host);
    if (!missing) return lock;
    if (chosen) {
      return fail(ErrorCode::kEnvironment,
                  fmt::format("DDS domain {}: another program has its UDP port {}; end it, choose "
                              "another domain, or leave out --domain to get a free one",
                              domain, *missing));
    }
  }
  return fail(
      ErrorCode::kEnvironment,
      chosen ? fmt::format("DDS domain {} (of {} in a row) is in use by another run", wanted, block)
             : "no free DDS domain: too many runs or other programs on this machine");
}

}  // namespace swarm::link
