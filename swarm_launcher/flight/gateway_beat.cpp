// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/gateway_beat.hpp"

#include <array>
#include <cstddef>
#include <cstring>
#include <string>

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace swarm::launcher {
namespace {

int open_socket() { return ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0); }

struct Beat {
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
  const int on = 1;
  (void)::setsockopt(fd_, SOL_SOCKET, SO_PASSCRED, &on, sizeof on);
  const Address address(launcher);
  (void)::bind(fd_, address.get(), address.size);
}

GatewayBeatReceiver::~GatewayBeatReceiver() { ::close(fd_); }

/// Any process of the machine can send to an abstract name: what counts is the sender's process, as
/// the kernel has it. At most those of thirteen seconds at once.
std::optional<std::uint32_t> GatewayBeatReceiver::take(pid_t gateway) {
  constexpr int kMostAtOnce = 64;
  std::optional<std::uint32_t> robots;
  for (int i = 0; i < kMostAtOnce; ++i) {
    Beat beat{};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(ucred))> control{};
    iovec part{.iov_base = &beat, .iov_len = sizeof beat};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t size = ::recvmsg(fd_, &message, MSG_CMSG_CLOEXEC);
    if (size < 0) break;
    const cmsghdr* const header = CMSG_FIRSTHDR(&message);
    if (size != sizeof beat || header == nullptr || header->cmsg_type != SCM_CREDENTIALS) continue;
    ucred sender{};
    std::memcpy(&sender, CMSG_DATA(header), sizeof sender);
    if (sender.pid == gateway) robots = beat.robots;
  }
  return robots;
}

GatewayBeatSender::GatewayBeatSender(pid_t launcher) : launcher_(launcher), fd_(open_socket()) {}

GatewayBeatSender::~GatewayBeatSender() { ::close(fd_); }

void GatewayBeatSender::send(std::uint32_t robots, SteadyTime now) {
  next_ = now + kGatewayBeatPeriod;
  const Address address(launcher_);
  const Beat beat{.robots = robots};
  (void)::sendto(fd_, &beat, sizeof beat, MSG_NOSIGNAL, address.get(), address.size);
}

}  // namespace swarm::launcher
