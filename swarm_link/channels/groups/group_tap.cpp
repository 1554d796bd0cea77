// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/channels/groups/group_tap.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "swarm_link/cdr/codec.hpp"
#include "swarm_link/channels/groups/rtps_datagram.hpp"
#include "swarm_link/udp_socket.hpp"

namespace swarm::link {
namespace {

// Holds the bursts of all robots of a machine, which publish within the same control period.
constexpr int kBufferBytes = 8 << 20;

// A socket bound to the groups' port without an address; see GroupTap.
class SocketTap final : public GroupTap, private DatagramSink {
 public:
  explicit SocketTap(int fd) : fd_(fd) {}
  ~SocketTap() override { ::close(fd_); }
  SocketTap(const SocketTap&) = delete;
  SocketTap& operator=(const SocketTap&) = delete;

  std::size_t take(Duration timeout, std::vector<CellStatesMessage>& out) override {
    if (!wait(timeout)) return 0;
    taking_ = &out;
    const std::size_t before = out.size();
    drain_.drain(fd_, *this);
    taking_ = nullptr;
    return out.size() - before;
  }

  std::size_t take_raw(Duration timeout, const RawSink& sink) override {
    if (!wait(timeout)) return 0;
    sink_ = &sink;
    sunk_ = 0;
    drain_.drain(fd_, *this);
    sink_ = nullptr;
    return sunk_;
  }

  std::uint64_t undecodable() const override { return undecodable_; }

 private:
  // Passes the payload to the raw sink or decodes it, depending on which take function is active.
  void datagram(std::span<std::byte> bytes, const sockaddr_in&) override {
    const auto payload = decode_rtps(bytes);
    if (payload && sink_ != nullptr) {
      ++sunk_;
      (*sink_)(*payload);
      return;
    }
    if (payload && taking_ != nullptr && decode(*payload, taking_->emplace_back())) return;
    if (payload && taking_ != nullptr) taking_->pop_back();
    ++undecodable_;
  }

  // Waits until a datagram is there; false at the end of the timeout.
  bool wait(Duration timeout) const {
    pollfd waiting{.fd = fd_, .events = POLLIN, .revents = 0};
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(timeout).count();
    return ::poll(&waiting, 1, static_cast<int>(ms)) > 0;
  }

  int fd_;
  DatagramDrain drain_;
  std::vector<CellStatesMessage>* taking_ = nullptr;
  const RawSink* sink_ = nullptr;
  std::size_t sunk_ = 0;
  std::uint64_t undecodable_ = 0;
};

}  // namespace

Result<std::unique_ptr<GroupTap>> make_group_tap(std::uint32_t domain) {
  sockaddr_in anywhere = multicast_group(domain, 0);
  const int port = ntohs(anywhere.sin_port);
  anywhere.sin_addr.s_addr = htonl(INADDR_ANY);
  const int fd = open_receive_socket(anywhere, kBufferBytes, true);
  if (fd < 0) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("cannot listen at UDP port {} for the states of DDS domain {}; end the "
                            "process that uses it, or use another domain",
                            port, domain));
  }
  return std::make_unique<SocketTap>(fd);
}

}  // namespace swarm::link
