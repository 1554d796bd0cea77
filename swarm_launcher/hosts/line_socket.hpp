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
Result<HostPort> parse_host_port(const std::string& text);

/// One end of a TCP connection that speaks in lines, with blocks of raw bytes between them. Never
/// waits: what does not go out now goes out at a later flush(). A peer that is unreachable for a
/// minute is gone.
class LineSocket {
 public:
  explicit LineSocket(int fd);
  LineSocket(LineSocket&& other) noexcept;
  LineSocket& operator=(LineSocket&& other) noexcept;
  ~LineSocket();

  /// Connects, waiting for at most ten seconds.
  static Result<LineSocket> connect(const HostPort& to);

  void send(std::string_view line);
  void send_bytes(std::string_view bytes) { out_ += bytes; }
  /// Bytes that have not gone out yet.
  std::size_t unsent() const { return out_.size() - sent_; }
  void flush();

  static constexpr std::size_t kMaxLine = 16U << 20U;  // a mission with its drawing

  /// Takes what has arrived, as long as less than `held` waits to be read.
  void receive(std::size_t held = 2 * kMaxLine);
  /// The next line without its end, if one is there. A longer one than `most` is not for us.
  std::optional<std::string> line(std::size_t most = kMaxLine);
  /// Up to `most` of the bytes that have arrived.
  std::string bytes(std::size_t most);

  /// Nothing more will be said; the other end reads what was.
  void finish();
  void close();
  /// The other end closed, broke off, or sent a line that is too long.
  bool gone() const { return gone_; }
  /// Our address on the way to the other end.
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

  std::optional<LineSocket> accept();
  std::uint16_t port() const { return port_; }

 private:
  LineServer(int fd, std::uint16_t port) : fd_(fd), port_(port) {}
  int fd_;
  std::uint16_t port_;
};

}  // namespace swarm::launcher
