// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/hosts/line_socket.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>
#include <utility>

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace swarm::launcher {
namespace {

constexpr int kConnect_ms = 10'000;
constexpr int kUnreachable_ms = 60'000;
constexpr int kAlive_s = 10;  // silence after which the kernel probes the peer

using Addresses = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

// Resolves a name to IPv4 addresses; DDS uses IPv4 as well.
Result<Addresses> resolve(const HostPort& at) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int code = ::getaddrinfo(at.host.c_str(), std::to_string(at.port).c_str(), &hints, &found);
  if (code != 0) {
    return fail(ErrorCode::kBadInput,
                fmt::format("'{}' is no host: {}", at.host, ::gai_strerror(code)));
  }
  return Addresses(found, &::freeaddrinfo);
}

tl::unexpected<Error> failed(const char* what, const HostPort& at, int code) {
  return fail(ErrorCode::kEnvironment,
              fmt::format("cannot {} {}:{}: {}", what, at.host, at.port, std::strerror(code)));
}

}  // namespace

// The last colon separates the port, which must be a decimal number to the end of the text.
Result<HostPort> parse_host_port(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  HostPort out{.host = text.substr(0, colon)};
  const char* const first =
      text.data() + std::min(text.size(), colon == std::string::npos ? text.size() : colon + 1);
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(first, last, out.port);
  if (first == last || end != last || error != std::errc{} || out.host.empty()) {
    return fail(ErrorCode::kBadInput,
                fmt::format("'{}' is not HOST:PORT, like 10.0.0.1:7000", text));
  }
  return out;
}

// Non-blocking and without delay for small lines. Keep-alive detects a peer that vanished while
// nothing is sent, the user timeout one that does not acknowledge.
LineSocket::LineSocket(int fd) : fd_(fd) {
  const int yes = 1;
  const auto unreachable = static_cast<unsigned>(kUnreachable_ms);
  ::fcntl(fd_, F_SETFL, ::fcntl(fd_, F_GETFL) | O_NONBLOCK);
  ::setsockopt(fd_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  ::setsockopt(fd_, SOL_SOCKET, SO_KEEPALIVE, &yes, sizeof yes);
  ::setsockopt(fd_, IPPROTO_TCP, TCP_KEEPIDLE, &kAlive_s, sizeof kAlive_s);
  ::setsockopt(fd_, IPPROTO_TCP, TCP_KEEPINTVL, &kAlive_s, sizeof kAlive_s);
  ::setsockopt(fd_, IPPROTO_TCP, TCP_USER_TIMEOUT, &unreachable, sizeof unreachable);
}

LineSocket::LineSocket(LineSocket&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      gone_(other.gone_),
      in_(std::move(other.in_)),
      read_(other.read_),
      out_(std::move(other.out_)),
      sent_(other.sent_) {}

LineSocket& LineSocket::operator=(LineSocket&& other) noexcept {
  std::swap(fd_, other.fd_);
  std::swap(gone_, other.gone_);
  std::swap(in_, other.in_);
  std::swap(read_, other.read_);
  std::swap(out_, other.out_);
  std::swap(sent_, other.sent_);
  return *this;
}

LineSocket::~LineSocket() {
  if (fd_ >= 0) ::close(fd_);
}

// A non-blocking connect: the socket becomes writable when the connection is made or has failed,
// and SO_ERROR then contains the result.
Result<LineSocket> LineSocket::connect(const HostPort& to) {
  const auto addresses = resolve(to);
  if (!addresses) return tl::unexpected(addresses.error());
  LineSocket socket(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const addrinfo& first = **addresses;
  if (::connect(socket.fd_, first.ai_addr, first.ai_addrlen) != 0 && errno != EINPROGRESS) {
    return failed("connect to", to, errno);
  }
  pollfd waiting{.fd = socket.fd_, .events = POLLOUT, .revents = 0};
  if (::poll(&waiting, 1, kConnect_ms) != 1) return failed("connect to", to, ETIMEDOUT);
  int error = 0;
  socklen_t size = sizeof error;
  ::getsockopt(socket.fd_, SOL_SOCKET, SO_ERROR, &error, &size);
  if (error != 0) return failed("connect to", to, error);
  return socket;
}

void LineSocket::send(std::string_view line) {
  out_ += line;
  out_ += '\n';
  flush();
}

// Sends until the kernel's buffer is full. The queue is only compacted when it is empty.
void LineSocket::flush() {
  while (!gone_ && sent_ < out_.size()) {
    const ssize_t n = ::send(fd_, out_.data() + sent_, out_.size() - sent_, MSG_NOSIGNAL);
    if (n <= 0) {
      gone_ = errno != EAGAIN && errno != EINTR;
      break;
    }
    sent_ += static_cast<std::size_t>(n);
  }
  if (sent_ == out_.size()) {
    out_.clear();
    sent_ = 0;
  }
}

// Drops what was read before, then reads until nothing is left or the limit is reached.
void LineSocket::receive(std::size_t held) {
  in_.erase(0, read_);
  read_ = 0;
  std::array<char, 65'536> buffer;
  while (!gone_ && in_.size() - read_ < held) {
    const ssize_t n = ::recv(fd_, buffer.data(), buffer.size(), 0);
    if (n > 0) {
      in_.append(buffer.data(), static_cast<std::size_t>(n));
      continue;
    }
    gone_ = n == 0 || (errno != EAGAIN && errno != EINTR);
    break;
  }
}

// A too long line is recognised before its end arrives, so buffers stay bounded.
std::optional<std::string> LineSocket::line(std::size_t most) {
  const std::size_t end = in_.find('\n', read_);
  const std::size_t size = std::min(end, in_.size()) - read_;  // so far, if it has no end yet
  gone_ = gone_ || size > most;
  if (end == std::string::npos || size > most) return std::nullopt;
  std::string out = in_.substr(read_, end - read_);
  read_ = end + 1;
  return out;
}

std::string LineSocket::bytes(std::size_t most) {
  std::string out = in_.substr(read_, most);
  read_ += out.size();
  return out;
}

std::string LineSocket::own_address() const {
  sockaddr_in own{};
  socklen_t size = sizeof own;
  std::array<char, INET_ADDRSTRLEN> text{};
  if (::getsockname(fd_, reinterpret_cast<sockaddr*>(&own), &size) != 0) return "127.0.0.1";
  return ::inet_ntop(AF_INET, &own.sin_addr, text.data(), text.size());
}

void LineSocket::finish() { ::shutdown(fd_, SHUT_WR); }

void LineSocket::close() {
  if (fd_ >= 0) ::close(std::exchange(fd_, -1));
  gone_ = true;
}

// Also wakes up when queued bytes can be sent.
void LineSocket::wait(int at_most_ms) const {
  if (gone_) {  // poll() would return at once
    ::poll(nullptr, 0, at_most_ms);
    return;
  }
  const auto events = static_cast<short>(POLLIN | (unsent() > 0 ? POLLOUT : 0));
  pollfd waiting{.fd = fd_, .events = events, .revents = 0};
  ::poll(&waiting, 1, at_most_ms);
}

// SO_REUSEADDR: connections of an earlier run in TIME_WAIT must not block the port.
Result<LineServer> LineServer::listen(const HostPort& at) {
  const auto addresses = resolve(at);
  if (!addresses) return tl::unexpected(addresses.error());
  LineServer server(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0), 0);
  const int yes = 1;
  ::setsockopt(server.fd_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  const addrinfo& first = **addresses;
  sockaddr_in bound{};
  socklen_t size = sizeof bound;
  if (::bind(server.fd_, first.ai_addr, first.ai_addrlen) != 0 || ::listen(server.fd_, 8) != 0 ||
      ::getsockname(server.fd_, reinterpret_cast<sockaddr*>(&bound), &size) != 0) {
    return failed("listen at", at, errno);
  }
  server.port_ = ntohs(bound.sin_port);
  return server;
}

LineServer::LineServer(LineServer&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), port_(other.port_) {}

LineServer::~LineServer() {
  if (fd_ >= 0) ::close(fd_);
}

std::optional<LineSocket> LineServer::accept() {
  const int fd = ::accept4(fd_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (fd < 0) return std::nullopt;
  return LineSocket(fd);
}

}  // namespace swarm::launcher
