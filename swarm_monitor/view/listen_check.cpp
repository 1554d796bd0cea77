// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/listen_check.hpp"

#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

namespace swarm::monitor {

/// Binds and listens once, then closes: the error code of bind() is what the message reports.
/// SO_REUSEADDR keeps a port usable whose last connections are in TIME_WAIT.
Result<void> can_bind(const std::string& address, std::uint16_t port) {
  addrinfo hints = {};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) {
    return fail(ErrorCode::kBadInput, fmt::format("{} is no address to listen on", address));
  }
  const int fd = ::socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int yes = 1;
  ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  const bool bound = ::bind(fd, found->ai_addr, found->ai_addrlen) == 0 && ::listen(fd, 1) == 0;
  const int error = errno;
  ::freeaddrinfo(found);
  ::close(fd);
  if (bound) return {};
  return fail(ErrorCode::kEnvironment,
              fmt::format("cannot listen on {} port {}: {}", address, port, std::strerror(error)));
}

}  // namespace swarm::monitor
