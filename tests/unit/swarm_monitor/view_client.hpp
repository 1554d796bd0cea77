// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace swarm::monitor {

/// A client on a bare socket that can do everything wrong. Never blocks.
class ViewClient {
 public:
  explicit ViewClient(std::uint16_t port, int receive_buffer = 0) : port_(port) {
    fd_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (receive_buffer > 0) {
      ::setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof(receive_buffer));
    }
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    open_ = ::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  }
  ~ViewClient() { ::close(fd_); }
  ViewClient(const ViewClient&) = delete;
  ViewClient& operator=(const ViewClient&) = delete;

  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t n = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (n <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(n));
    }
    return true;
  }

  /// Asks for a WebSocket; the last lines may be any headers.
  bool upgrade(std::string_view path, std::string_view protocol, std::string_view more = "") {
    return send(fmt::format(
        "GET {} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nUpgrade: websocket\r\n"
        "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n{}{}\r\n",
        path, port_,
        protocol.empty() ? std::string() : fmt::format("Sec-WebSocket-Protocol: {}\r\n", protocol),
        more));
  }

  /// A masked frame. Opcodes: 0 goes on, 1 text, 2 binary, 8 close, 9 ping.
  static std::string frame(std::string_view payload, unsigned opcode = 1, bool final = true) {
    std::string bytes(1, static_cast<char>(opcode | (final ? 0x80U : 0U)));
    if (payload.size() < 126) {
      bytes += static_cast<char>(0x80U | payload.size());
    } else if (payload.size() < 65536) {
      bytes += static_cast<char>(0x80U | 126U);
      bytes += static_cast<char>(payload.size() >> 8U);
      bytes += static_cast<char>(payload.size() & 0xFFU);
    } else {
      bytes += static_cast<char>(0x80U | 127U);
      for (int shift = 56; shift >= 0; shift -= 8) {
        bytes += static_cast<char>((payload.size() >> static_cast<unsigned>(shift)) & 0xFFU);
      }
    }
    constexpr std::array<char, 4> kMask = {0x12, 0x34, 0x56, 0x78};
    bytes.append(kMask.data(), kMask.size());
    for (std::size_t i = 0; i < payload.size(); ++i) {
      bytes += static_cast<char>(payload[i] ^ kMask[i % 4]);
    }
    return bytes;
  }
  bool send_text(std::string_view text) { return send(frame(text)); }

  /// Takes in what has come.
  void read() {
    std::array<char, 65536> buffer;
    ssize_t n = 0;
    while ((n = ::recv(fd_, buffer.data(), buffer.size(), MSG_DONTWAIT)) > 0) {
      input.append(buffer.data(), static_cast<std::size_t>(n));
    }
    if (n == 0 || (n < 0 && errno != EAGAIN)) open_ = false;
  }

  struct Message {
    unsigned opcode = 0;
    std::string payload{};
  };
  /// The next whole message of the input.
  std::optional<Message> message() {
    if (input.size() < 2) return std::nullopt;
    const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(input[i]); };
    std::size_t head = 2;
    std::uint64_t size = byte(1) & 0x7FU;
    if (size >= 126) {
      const std::size_t more = size == 126 ? 2 : 8;
      if (input.size() < head + more) return std::nullopt;
      size = 0;
      for (std::size_t i = 0; i < more; ++i) size = size << 8U | byte(head + i);
      head += more;
    }
    if (input.size() < head + size) return std::nullopt;
    Message out{.opcode = byte(0) & 0x0FU, .payload = input.substr(head, size)};
    input.erase(0, head + size);
    return out;
  }

  bool open() const { return open_; }

  std::string input{};

 private:
  std::uint16_t port_;
  int fd_ = -1;
  bool open_ = false;
};

}  // namespace swarm::monitor
