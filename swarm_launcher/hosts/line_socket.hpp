// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// An address like "10.0.0.1:7000". IPv4 or a name.
struct HostPort {
  std::string host;
  std::uint16_t port = 0;
};
/// Fails unless the text is HOST:PORT.
Result<HostPort> parse_host_port(const std::string& text);

/// One end of a TCP connection that carries lines of text, with blocks of raw bytes between them.
/// Its functions do not block, except connect() and wait(): what cannot be sent now is sent by a
/// later flush(). A peer that is unreachable for a minute counts as gone. Not thread-safe.
class LineSocket {
 public:
  explicit LineSocket(int fd);
  LineSocket(LineSocket&& other) noexcept;
  LineSocket& operator=(LineSocket&& other) noexcept;
  ~LineSocket();

  /// Connects, waiting for at most ten seconds.
  static Result<LineSocket> connect(const HostPort& to);

  /// Queues a line, or bytes as they are, and sends what the kernel accepts.
  void send(std::string_view line);
  void send_bytes(std::string_view bytes) { out_ += bytes; }
  /// Bytes queued and not yet accepted by the kernel.
  std::size_t unsent() const { return out_.size() - sent_; }
  void flush();

  static constexpr std::size_t kMaxLine = 16U << 20U;  // room for a mission file in an offer

  /// Reads what has arrived while fewer than `held` bytes are buffered, so that a peer cannot fill
  /// our memory.
  void receive(std::size_t held = 2 * kMaxLine);
  /// The next complete line, without its end. A peer whose line exceeds `most` bytes counts as
  /// gone.
  std::optional<std::string> line(std::size_t most = kMaxLine);
  /// Up to `most` of the bytes that have arrived.
  std::string bytes(std::size_t most);

  /// Closes our direction only; the peer still receives what was sent.
  void finish();
  void close();
  /// The peer closed the connection, or it failed, or the peer sent a line that is too long.
  bool gone() const { return gone_; }
  /// Our own address on the route to the peer.
  std::string own_address() const;
  /// Sleeps until something arrives or the time is over.
  void wait(int at_most_ms) const;

 private:
  int fd_;
  bool gone_ = false;
  std::string in_;
  std::size_t read_ = 0;  // of in_
  std::string out_;
  std::size_t sent_ = 0;  // of out_
};

/// A socket that listens at an address; port 0 takes a free one. Not blocking.
class LineServer {
 public:
  static Result<LineServer> listen(const HostPort& at);
  LineServer(LineServer&& other) noexcept;
  LineServer& operator=(LineServer&&) = delete;
  ~LineServer();

  /// The next connection, if one waits.
  std::optional<LineSocket> accept();
  std::uint16_t port() const { return port_; }

 private:
  LineServer(int fd, std::uint16_t port) : fd_(fd), port_(port) {}
  int fd_;
  std::uint16_t port_;
};

}  // namespace swarm::launcher
