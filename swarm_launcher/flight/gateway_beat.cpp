// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/gateway_beat.hpp"

#include <cstddef>
#include <string>

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace swarm::launcher {
namespace {

int open_socket() { return ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0); }

struct Beat {
  pid_t gateway;
  std::uint32_t robots;
};

/// An abstract name: no file that others remove or that a full disk refuses.
struct Address {
  explicit Address(pid_t launcher) {
    const std::string name = fmt::format("swarmflow-gateway-{}", launcher);
    address.sun_family = AF_UNIX;
    name.copy(address.sun_path + 1, sizeof address.sun_path - 1);
    size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  }
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address); }

  sockaddr_un address{};
  socklen_t size;
};

}  // namespace

GatewayBeatReceiver::GatewayBeatReceiver(pid_t launcher) : fd_(open_socket()) {
  const Address address(launcher);
  (void)::bind(fd_, address.get(), address.size);
}

GatewayBeatReceiver::~GatewayBeatReceiver() { ::close(fd_); }

std::optional<std::uint32_t> GatewayBeatReceiver::take(pid_t gateway) {
  std::optional<std::uint32_t> robots;
  Beat beat{};
  ssize_t size = 0;
  while ((size = ::recv(fd_, &beat, sizeof beat, 0)) >= 0) {
    if (size == sizeof beat && beat.gateway == gateway) robots = beat.robots;
  }
  return robots;
}

GatewayBeatSender::GatewayBeatSender(pid_t launcher) : launcher_(launcher), fd_(open_socket()) {}

GatewayBeatSender::~GatewayBeatSender() { ::close(fd_); }

void GatewayBeatSender::send(std::uint32_t robots, SteadyTime now) {
  next_ = now + kGatewayBeatPeriod;
  const Address address(launcher_);
  const Beat beat{.gateway = ::getpid(), .robots = robots};
  (void)::sendto(fd_, &beat, sizeof beat, MSG_NOSIGNAL, address.get(), address.size);
}

}  // namespace swarm::launcher
