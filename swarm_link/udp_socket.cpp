// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/udp_socket.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <ctime>
#include <memory>
#include <utility>

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "swarm_core/base/assert.hpp"
#include "swarm_core/base/clock.hpp"

namespace swarm::link {

namespace {

constexpr std::size_t kDatagramBytes = 65'536;
// Datagrams per system call; buffers of the largest datagram size.
constexpr std::size_t kBatch = 32;

bool set_membership(int fd, int option, const in_addr& group, const in_addr& interface) {
  ip_mreqn request{};
  request.imr_multiaddr = group;
  request.imr_address = interface;
  return ::setsockopt(fd, IPPROTO_IP, option, &request, sizeof request) == 0;
}

/// Time at which the kernel received a datagram, if the socket has SO_TIMESTAMPNS set. The kernel
/// stamps by the wall clock; the age by it counts, unless that clock was set in between.
UtcTime received_at(msghdr& message, UtcTime now) {
  constexpr Duration kMostAge = std::chrono::seconds(10);
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr;
       part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_TIMESTAMPNS) continue;
    timespec stamp{};
    std::memcpy(&stamp, CMSG_DATA(part), sizeof stamp);
    const UtcTime at(std::chrono::seconds(stamp.tv_sec) + Duration(stamp.tv_nsec));
    const Duration age = wall_clock_now() - at;
    return age >= Duration::zero() && age <= kMostAge ? now - age : now;
  }
  return now;
}

/// What the kernel fills in. Prepared once: that took longer than a system call that finds nothing.
struct Batch {
  struct alignas(cmsghdr) Stamp {
    std::array<std::byte, CMSG_SPACE(sizeof(timespec))> bytes;
  };

  Batch() {
    for (std::size_t i = 0; i < kBatch; ++i) {
      vectors[i] = {buffer(i), kDatagramBytes};
      messages[i].msg_hdr.msg_name = &senders[i];
      messages[i].msg_hdr.msg_namelen = sizeof(sockaddr_in);
      messages[i].msg_hdr.msg_iov = &vectors[i];
      messages[i].msg_hdr.msg_iovlen = 1;
    }
  }
  Batch(const Batch&) = delete;
  Batch& operator=(const Batch&) = delete;

  std::byte* buffer(std::size_t i) const { return buffers.get() + i * kDatagramBytes; }
  void ask_for_stamps() {
    for (std::size_t i = 0; i < kBatch; ++i) {
      messages[i].msg_hdr.msg_control = stamps[i].bytes.data();
      messages[i].msg_hdr.msg_controllen = sizeof(Stamp);
    }
  }
  void forget_stamps() {
    for (mmsghdr& message : messages) {
      message.msg_hdr.msg_control = nullptr;
      message.msg_hdr.msg_controllen = 0;
    }
  }

  // Pages that are never written take no memory.
  std::unique_ptr<std::byte[]> buffers{new std::byte[kBatch * kDatagramBytes]};
  std::array<mmsghdr, kBatch> messages{};
  std::array<iovec, kBatch> vectors{};
  std::array<sockaddr_in, kBatch> senders{};
  std::array<Stamp, kBatch> stamps{};
  bool is_in_use = false;
};

Batch& batch_of_this_thread() {
  static thread_local Batch batch;
  return batch;
}

}  // namespace

in_addr to_in_addr(const std::string& address) {
  in_addr out{};
  if (::inet_pton(AF_INET, address.c_str(), &out) != 1) out.s_addr = htonl(INADDR_LOOPBACK);
  return out;
}

bool is_multicast(const in_addr& address) { return IN_MULTICAST(ntohl(address.s_addr)); }

// 7401 + 250·domain is the port that DDSI-RTPS defines for user multicast.
sockaddr_in multicast_group(std::uint32_t domain, std::uint32_t hash) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(0xEFFF0000U | (hash & 0xFFFFU));
  address.sin_port = htons(static_cast<std::uint16_t>(7401 + 250 * domain));
  return address;
}

// Sets the options before bind(): the address can be shared only if all its sockets request it.
int open_receive_socket(const sockaddr_in& address, int buffer_bytes, bool shared) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) return -1;
  ::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &buffer_bytes, sizeof buffer_bytes);
  if (const int yes = 1; shared || is_multicast(address.sin_addr)) {
    ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  }
  if (const int no = 0; is_multicast(address.sin_addr)) {  // not what other sockets have joined
    ::setsockopt(fd, IPPROTO_IP, IP_MULTICAST_ALL, &no, sizeof no);
  }
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return fd;
  ::close(fd);
  return -1;
}

bool join_group(int fd, const in_addr& group, const in_addr& interface) {
  return set_membership(fd, IP_ADD_MEMBERSHIP, group, interface);
}

bool leave_group(int fd, const in_addr& group, const in_addr& interface) {
  return set_membership(fd, IP_DROP_MEMBERSHIP, group, interface);
}

int open_group_sender(const in_addr& interface) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) return -1;
  ip_mreqn through{};
  through.imr_address = interface;
  if (::setsockopt(fd, IPPROTO_IP, IP_MULTICAST_IF, &through, sizeof through) == 0) return fd;
  ::close(fd);
  return -1;
}

// Uses a real datagram, because interfaces may have the flag MULTICAST and yet drop such packets
// (lo without a route, firewalls).
bool carries_multicast(const std::string& interface) {
  constexpr int kTimeout_ms = 200;  // loopback delivers within sendto(), others soon after
  const in_addr own = to_in_addr(interface);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(0xEFFF0000);  // 239.255.0.0; port 0: any free one
  socklen_t size = sizeof address;
  const int receiver = open_receive_socket(address, 1 << 16);
  const int sender = open_group_sender(own);
  pollfd waiting{.fd = receiver, .events = POLLIN, .revents = 0};
  char back = 0;
  const bool received =
      receiver >= 0 && sender >= 0 && join_group(receiver, address.sin_addr, own) &&
      ::getsockname(receiver, reinterpret_cast<sockaddr*>(&address), &size) == 0 &&
      ::sendto(sender, "?", 1, 0, reinterpret_cast<const sockaddr*>(&address), size) == 1 &&
      ::poll(&waiting, 1, kTimeout_ms) == 1 && ::recv(receiver, &back, 1, 0) == 1;
  if (receiver >= 0) ::close(receiver);
  if (sender >= 0) ::close(sender);
  return received;
}

// The kernel silently limits a buffer to net.core.rmem_max; this asks it what it granted.
int granted_receive_buffer_bytes(int asked_bytes) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return 0;
  int granted = 0;
  socklen_t size = sizeof granted;
  ::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &asked_bytes, sizeof asked_bytes);
  ::getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &granted, &size);
  ::close(fd);
  return granted / 2;  // the kernel reports twice what was asked, for its own bookkeeping
}

// With simulated faults the kernel stamps the arrivals, so that a delay counts from the arrival and
// not from this call. A batch that is not full means that the socket is empty.
void DatagramDrain::drain(int fd, DatagramSink& sink) {
  if (path_) {
    const int yes = 1;
    ::setsockopt(fd, SOL_SOCKET, SO_TIMESTAMPNS, &yes, sizeof yes);
  }
  for (int received = 0; received < kMaxDatagrams;) {
    const int batch = drain_batch(fd, sink);
    received += batch;
    if (batch < static_cast<int>(kBatch)) break;
  }
  if (path_) path_->hand_due(fd, utc_now(), sink);
}

// Receives up to kBatch datagrams with one system call. Returns their number.
int DatagramDrain::drain_batch(int fd, DatagramSink& sink) {
  Batch& batch = batch_of_this_thread();
  SWARM_ASSERT(!std::exchange(batch.is_in_use, true));
  if (path_) batch.ask_for_stamps();
  const int count =
      std::max(0, ::recvmmsg(fd, batch.messages.data(), kBatch, MSG_DONTWAIT, nullptr));
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const std::span<std::byte> bytes{batch.buffer(i), batch.messages[i].msg_len};
    if (path_) {
      path_->receive(fd, bytes, batch.senders[i],
                     received_at(batch.messages[i].msg_hdr, utc_now()));
    } else {
      sink.datagram(bytes, batch.senders[i]);
    }
    batch.messages[i].msg_hdr.msg_namelen = sizeof(sockaddr_in);  // the kernel wrote what it used
  }
  if (path_) batch.forget_stamps();
  batch.is_in_use = false;
  return count;
}

}  // namespace swarm::link
