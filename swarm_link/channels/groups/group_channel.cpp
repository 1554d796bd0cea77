// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/channels/groups/group_channel.hpp"

#include <algorithm>
#include <cerrno>
#include <random>
#include <vector>

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include "swarm_link/cdr/codec.hpp"
#include "swarm_link/channels/cell_traffic.hpp"
#include "swarm_link/channels/groups/rtps_datagram.hpp"
#include "swarm_link/udp_socket.hpp"

namespace swarm::link {

namespace {

// Hashes a cell into the 65536 groups of 239.255.0.0/16. The factor 359 is 2·179 + 1: cells that
// are at most 181 columns and 179 rows apart get different values.
sockaddr_in group_of(std::uint32_t domain, const Cell& cell) {
  return multicast_group(
      domain, static_cast<std::uint32_t>(cell.x) * 359U + static_cast<std::uint32_t>(cell.y));
}

// Random, so that a restarted process is another writer for RTPS tools.
GuidPrefix random_prefix() {
  std::random_device device;
  GuidPrefix prefix{};
  for (std::uint8_t& byte : prefix) byte = static_cast<std::uint8_t>(device() & 0xFFU);
  return prefix;
}

/// One socket per group: the kernel then finds the few receivers of a datagram by its address.
/// (With sockets of many groups it would check every receiver of the machine, and Linux limits a
/// socket to 20 groups.) The number of open files is the limit.
class GroupSocket {
 public:
  GroupSocket(const sockaddr_in& group, const in_addr& interface, int buffer_bytes)
      : fd_(open_receive_socket(group, buffer_bytes)),
        lacks_files_(fd_ < 0 && (errno == EMFILE || errno == ENFILE)),
        joined_(fd_ >= 0 && join_group(fd_, group.sin_addr, interface)) {}
  ~GroupSocket() {
    if (fd_ >= 0) ::close(fd_);  // which also ends the membership
  }
  GroupSocket(GroupSocket&& other) noexcept
      : fd_(std::exchange(other.fd_, -1)),
        lacks_files_(other.lacks_files_),
        joined_(other.joined_) {}
  GroupSocket& operator=(GroupSocket&& other) noexcept {
    std::swap(fd_, other.fd_);
    std::swap(lacks_files_, other.lacks_files_);
    std::swap(joined_, other.joined_);
    return *this;
  }

  bool joined() const { return joined_; }
  /// It could not be opened, since process or machine have used up their open files.
  bool lacks_files() const { return lacks_files_; }
  int fd() const { return fd_; }

 private:
  int fd_;
  bool lacks_files_;
  bool joined_;
};

class GroupChannel final : public StateChannel, private DatagramSink {
 public:
  explicit GroupChannel(const GroupChannelOptions& options)
      : options_(options),
        interest_(options.cells),
        batches_(options.cells.cell_size_m),
        prefix_(random_prefix()),
        interface_(to_in_addr(options.interface)),
        sender_(open_group_sender(interface_)),
        drain_(options.faults) {}

  ~GroupChannel() override {
    if (sender_ >= 0) ::close(sender_);
  }

  bool can_send() const { return sender_ >= 0; }

  // One datagram per batch. A datagram that the kernel refuses is lost, like any other: the next
  // state follows a control period later.
  std::size_t publish(std::span<const RobotStateMessage> states) override {
    std::size_t sent = 0;
    for (const CellStatesMessage& batch : batches_.sort(states, &left_)) {
      if (!encode(batch, payload_)) continue;
      encode_rtps(prefix_, ++sequence_number_, payload_, datagram_);
      const sockaddr_in to = group_of(options_.domain, {batch.cell_x, batch.cell_y});
      if (::sendto(sender_, datagram_.data(), datagram_.size(), 0,
                   reinterpret_cast<const sockaddr*>(&to), sizeof to) >= 0) {
        sent += count_inside(batch);
      }
    }
    return sent;
  }

  // Leaves groups by closing their sockets, then joins new ones. Both lists are sorted by group, so
  // membership is looked up by binary search.
  void listen_around(std::span<const Vec2> positions_m) override {
    groups_.clear();  // two cells may have the same group
    for (const Cell& cell : interest_.update(positions_m)) {
      groups_.push_back(group_of(options_.domain, cell).sin_addr.s_addr);
    }
    std::sort(groups_.begin(), groups_.end());
    groups_.erase(std::unique(groups_.begin(), groups_.end()), groups_.end());
    lacks_files_ = false;
    receives_all_ = std::ranges::equal(joined_, groups_, {}, &Joined::group);
    if (receives_all_) return;  // at nearly every tick
    std::erase_if(joined_, [&](const Joined& joined) {
      const bool leaves = !std::ranges::binary_search(groups_, joined.group);
      if (leaves) sockets_.remove(joined.socket.fd());
      return leaves;
    });
    for (const in_addr_t group : groups_) {
      const auto at = std::lower_bound(joined_.begin(), joined_.end(), group,
                                       [](const Joined& j, in_addr_t g) { return j.group < g; });
      if (at != joined_.end() && at->group == group) continue;
      sockaddr_in address = group_of(options_.domain, {});
      address.sin_addr.s_addr = group;
      GroupSocket socket(address, interface_, options_.receive_buffer_bytes);
      lacks_files_ = lacks_files_ || socket.lacks_files();
      if (!socket.joined()) continue;
      sockets_.add(socket.fd());
      joined_.insert(at, {group, std::move(socket)});
    }
    receives_all_ = joined_.size() == groups_.size();
  }

  bool receives_at(const Vec2& position_m) const override { return interest_.covers(position_m); }
  bool receives_all() const override { return receives_all_; }
  bool lacks_files() const override { return lacks_files_; }

  std::size_t take(std::vector<CellStatesMessage>& out) override {
    taking_ = &out;
    const auto before = out.size();
    for (const int fd : drain_.to_read(sockets_)) drain_.drain(fd, *this);
    return out.size() - before;
  }

  std::uint64_t undecodable() const override { return undecodable_; }

 private:
  struct Joined {
    in_addr_t group;
    GroupSocket socket;
  };

  // States of robots in the cell: the copies for cells that robots have left do not count.
  std::size_t count_inside(const CellStatesMessage& batch) const {
    const Cell cell{batch.cell_x, batch.cell_y};
    return static_cast<std::size_t>(
        std::ranges::count_if(batch.states, [&](const RobotStateMessage& state) {
          return cell_of({state.x_m, state.y_m}, options_.cells.cell_size_m) == cell;
        }));
  }

  // Decodes one datagram into the caller's vector; called by the drain during take().
  void datagram(std::span<std::byte> bytes, const sockaddr_in&) override {
    const auto payload = decode_rtps(bytes);
    if (payload && decode(*payload, taking_->emplace_back())) return;
    if (payload) taking_->pop_back();
    ++undecodable_;
  }

  GroupChannelOptions options_;
  CellInterest interest_;
  CellBatches batches_;
  LeftCells left_;
  bool receives_all_ = true;
  bool lacks_files_ = false;
  GuidPrefix prefix_;
  std::uint64_t sequence_number_ = 0;
  in_addr interface_;
  int sender_;
  DatagramDrain drain_;
  std::vector<Joined> joined_;     // sorted by group
  SocketSet sockets_;              // of these
  std::vector<in_addr_t> groups_;  // reused, as are the next two
  std::vector<std::byte> payload_;
  std::vector<std::byte> datagram_;
  std::vector<CellStatesMessage>* taking_ = nullptr;
  std::uint64_t undecodable_ = 0;
};

}  // namespace

GroupAddress group_address(std::uint32_t domain, Cell cell) {
  const sockaddr_in address = group_of(domain, cell);
  const std::uint32_t ip = ntohl(address.sin_addr.s_addr);
  return {.host = fmt::format("239.255.{}.{}", (ip >> 8U) & 0xFFU, ip & 0xFFU),
          .port = ntohs(address.sin_port)};
}

Result<std::unique_ptr<StateChannel>> make_group_channel(const GroupChannelOptions& options) {
  auto channel = std::make_unique<GroupChannel>(options);
  if (!channel->can_send() || !carries_multicast(options.interface)) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("the interface with address {} carries no multicast: set it up ('ip "
                            "link set lo up' for 127.0.0.1), let firewalls pass 239.255.0.0/16, or "
                            "use --channel topics",
                            options.interface));
  }
  return channel;
}

}  // namespace swarm::link
