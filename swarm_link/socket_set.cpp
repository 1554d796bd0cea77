// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/socket_set.hpp"

namespace swarm::link {

void SocketSet::add(int fd) {
  all_.push_back(fd);
  polled_.push_back({.fd = fd, .events = POLLIN, .revents = 0});
  waiting_.reserve(all_.size());
}

void SocketSet::remove(int fd) {
  std::erase(all_, fd);
  std::erase_if(polled_, [fd](const pollfd& polled) { return polled.fd == fd; });
}

// epoll(), whose cost grows with the waiting sockets alone, was no cheaper with fourteen: it makes
// every datagram dearer.
std::span<const int> SocketSet::waiting() {
  if (::poll(polled_.data(), polled_.size(), 0) < 0) return all_;
  waiting_.clear();
  for (const pollfd& polled : polled_) {
    if (polled.revents != 0) waiting_.push_back(polled.fd);
  }
  return waiting_;
}

}  // namespace swarm::link
