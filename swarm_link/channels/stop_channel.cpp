// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/channels/stop_channel.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <span>

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include "swarm_core/base/assert.hpp"
#include "swarm_link/cdr/codec.hpp"
#include "swarm_link/udp_socket.hpp"

namespace swarm::link {
namespace {

static_assert(std::endian::native == std::endian::little);  // of the ids in a confirmation

constexpr std::size_t kHeaderBytes = 8;
using Header = std::array<char, kHeaderBytes>;
constexpr Header kStop{'S', 'W', 'S', 'T', 'O', 'P', 0, 1};
constexpr Header kConfirmation{'S', 'W', 'S', 'T', 'O', 'P', 1, 2};
constexpr Header kBeat{'S', 'W', 'S', 'T', 'O', 'P', 2, 2};
constexpr std::size_t kMaxBeats = 8;  // kept of those that arrive between two calls
constexpr int kReceiveBytes = 1 << 18;
constexpr std::size_t kMaxSenders = 8;  // that are answered: launcher and commands, not a flood

/// Group 239.254.255.255, outside of the groups of cells, at the domain's port.
sockaddr_in group_of(std::uint32_t domain) {
  sockaddr_in group = multicast_group(domain, 0);
  group.sin_addr.s_addr = htonl(0xEFFEFFFFU);
  return group;
}

std::optional<std::span<const std::byte>> content_of(std::span<const std::byte> bytes,
                                                     const Header& header) {
  if (bytes.size() < kHeaderBytes) return std::nullopt;
  if (std::memcmp(bytes.data(), header.data(), kHeaderBytes) != 0) return std::nullopt;
  return bytes.subspan(kHeaderBytes);
}

void send_to(int fd, std::span<const std::byte> bytes, const sockaddr_in& to) {
  // A full socket loses this datagram; the next one follows soon.
  [[maybe_unused]] const auto sent =
      ::sendto(fd, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
               reinterpret_cast<const sockaddr*>(&to), sizeof to);
}

void close_if_open(int fd) {
  if (fd >= 0) ::close(fd);
}

tl::unexpected<Error> no_multicast(const std::string& interface) {
  return fail(ErrorCode::kEnvironment,
              fmt::format("stop channel: interface {} carries no multicast", interface));
}

}  // namespace

/// Sends to the group and receives the confirmations on the same socket.
struct StopSender::Impl : DatagramSink {
  Impl(const StopChannelOptions& options, int socket)
      : group(group_of(options.domain)), fd(socket), drain(options.faults) {}
  ~Impl() override { close_if_open(fd); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void datagram(std::span<std::byte> bytes, const sockaddr_in& /*sender*/) override {
    const auto content = content_of(bytes, kConfirmation);
    StopConfirmation confirmation;
    if (!content || content->size() != sizeof confirmation) return;
    std::memcpy(&confirmation, content->data(), sizeof confirmation);
    received.push_back(confirmation);
  }

  void send_sample(const Header& kind) {
    const auto header = std::as_bytes(std::span(kind));
    outgoing.assign(header.begin(), header.end());
    outgoing.insert(outgoing.end(), sample.begin(), sample.end());
    send_to(fd, outgoing, group);
  }

  sockaddr_in group;
  int fd;
  DatagramDrain drain;
  std::vector<std::byte> sample{};
  std::vector<std::byte> outgoing{};
  std::vector<StopConfirmation> received{};
};

StopSender::StopSender(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
StopSender::~StopSender() = default;

Result<std::unique_ptr<StopSender>> StopSender::open(const StopChannelOptions& options) {
  const int fd = open_group_sender(to_in_addr(options.interface));
  if (fd < 0) return no_multicast(options.interface);
  return std::unique_ptr<StopSender>(new StopSender(std::make_unique<Impl>(options, fd)));
}

void StopSender::send(const CommandMessage& stop) {
  SWARM_ASSERT(stop.kind == CommandKind::kStop);
  encode(stop, impl_->sample);
  impl_->send_sample(kStop);
}

void StopSender::send(const LauncherBeat& beat) {
  encode(beat, impl_->sample);
  impl_->send_sample(kBeat);
}

void StopSender::take(std::vector<StopConfirmation>& confirmations) {
  impl_->drain.drain(impl_->fd, *impl_);
  confirmations.insert(confirmations.end(), impl_->received.begin(), impl_->received.end());
  impl_->received.clear();
}

/// Listens in the group and answers senders directly.
struct StopReceiver::Impl : DatagramSink {
  struct Sender {
    sockaddr_in address;
    std::uint64_t command_id;  // of its last stop
  };

  Impl(const StopChannelOptions& options, int group_socket, int reply_socket)
      : fd(group_socket), reply_fd(reply_socket), drain(options.faults) {}
  ~Impl() override {
    close_if_open(fd);
    close_if_open(reply_fd);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void datagram(std::span<std::byte> bytes, const sockaddr_in& sender) override {
    if (const auto content = content_of(bytes, kBeat)) {
      // In place, as a beat is large; more than there is room for replace the last one.
      const std::size_t last = std::min(beats_received, kMaxBeats - 1);
      if (decode(*content, beats[last])) {
        beats_received = last + 1;
      } else {
        ++undecodable;
      }
      return;
    }
    const auto content = content_of(bytes, kStop);
    CommandMessage message;
    // Nothing but a stop, here already: another message must not take the place of one.
    const bool is_stop = content && decode(*content, message) &&
                         message.kind == CommandKind::kStop &&
                         message.schema_version == kSchemaVersion;
    if (!is_stop) {
      ++undecodable;
      return;
    }
    stop = message;
    const auto known = std::ranges::find_if(senders, [&](const Sender& s) {
      return s.address.sin_port == sender.sin_port &&
             s.address.sin_addr.s_addr == sender.sin_addr.s_addr;
    });
    if (known != senders.end()) {
      known->command_id = message.command_id;
    } else if (senders.size() < kMaxSenders) {
      senders.push_back({sender, message.command_id});
    }
  }

  int fd;
  int reply_fd;
  DatagramDrain drain;
  std::vector<LauncherBeat> beats{kMaxBeats};
  std::size_t beats_received = 0;
  std::optional<CommandMessage> stop{};
  std::vector<Sender> senders{};
  std::uint64_t undecodable = 0;
};

StopReceiver::StopReceiver(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
StopReceiver::~StopReceiver() = default;

Result<std::unique_ptr<StopReceiver>> StopReceiver::open(const StopChannelOptions& options) {
  const sockaddr_in group = group_of(options.domain);
  const in_addr interface = to_in_addr(options.interface);
  auto impl = std::make_unique<Impl>(options, open_receive_socket(group, kReceiveBytes),
                                     open_group_sender(interface));
  if (impl->fd < 0 || impl->reply_fd < 0 || !join_group(impl->fd, group.sin_addr, interface)) {
    return no_multicast(options.interface);
  }
  impl->senders.reserve(kMaxSenders);
  return std::unique_ptr<StopReceiver>(new StopReceiver(std::move(impl)));
}

std::optional<CommandMessage> StopReceiver::take() {
  impl_->stop.reset();
  impl_->beats_received = 0;
  impl_->drain.drain(impl_->fd, *impl_);
  return impl_->stop;
}

std::span<const LauncherBeat> StopReceiver::beats() const {
  return std::span(impl_->beats).first(impl_->beats_received);
}

std::uint64_t StopReceiver::undecodable() const { return impl_->undecodable; }

void StopReceiver::confirm(const RobotRange& stopped) {
  StopConfirmation confirmation{.first_robot_id = stopped.first, .robots = stopped.count};
  std::array<std::byte, kHeaderBytes + sizeof confirmation> bytes;
  std::memcpy(bytes.data(), kConfirmation.data(), kHeaderBytes);
  for (const Impl::Sender& sender : impl_->senders) {
    confirmation.command_id = sender.command_id;
    std::memcpy(bytes.data() + kHeaderBytes, &confirmation, sizeof confirmation);
    send_to(impl_->reply_fd, bytes, sender.address);
  }
  impl_->senders.clear();
}

}  // namespace swarm::link
