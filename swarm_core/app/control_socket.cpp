// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/control_socket.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "swarm_core/app/run_directory.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::shell {
namespace {

/// A client gives up when the launcher sends nothing for this long.
constexpr Duration kAnswerTimeout = std::chrono::seconds(15);
constexpr int kWait_ms = 20;                  // between two calls of on_wait
constexpr std::size_t kMaxLine = 256 * 1024;  // a polygon of 4096 corners

/// Socket addresses hold 107 characters; a path through /proc/self/fd is short for any directory.
class ShortAddress {
 public:
  explicit ShortAddress(const std::filesystem::path& run_dir)
      : dir_fd_(::open(run_dir.c_str(), O_DIRECTORY | O_PATH | O_CLOEXEC)) {
    address_.sun_family = AF_UNIX;
    const std::string path = fmt::format("/proc/self/fd/{}/{}", dir_fd_, kControlSocket);
    path.copy(address_.sun_path, sizeof(address_.sun_path) - 1);
  }
  ~ShortAddress() {
    if (dir_fd_ >= 0) ::close(dir_fd_);
  }
  ShortAddress(const ShortAddress&) = delete;
  ShortAddress& operator=(const ShortAddress&) = delete;

  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address_); }

 private:
  int dir_fd_;
  sockaddr_un address_ = {};
};

void send_line(int fd, const std::string& line) {
  const std::string text = line + "\n";
  // A client that does not read loses its answer; the launcher never waits for it.
  (void)::send(fd, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

}  // namespace

/// Removes the socket that a killed launcher may have left in the directory: bind() would refuse
/// it.
Result<ControlServer> ControlServer::listen(const std::filesystem::path& run_dir) {
  ControlServer server;
  server.socket_ = run_dir / kControlSocket;
  ::unlink(server.socket_.c_str());
  server.listen_fd_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const ShortAddress address(run_dir);
  const mode_t old_mask = ::umask(0077);  // only the user who runs the mission may command it
  const bool bound = ::bind(server.listen_fd_, address.get(), sizeof(sockaddr_un)) == 0;
  ::umask(old_mask);
  if (!bound || ::listen(server.listen_fd_, 8) != 0) {
    return fail(
        ErrorCode::kEnvironment,
        fmt::format("cannot listen on {}: {}", server.socket_.string(), std::strerror(errno)));
  }
  return server;
}

ControlServer::ControlServer(ControlServer&& other) noexcept
    : listen_fd_(std::exchange(other.listen_fd_, -1)),
      socket_(std::move(other.socket_)),
      clients_(std::exchange(other.clients_, {})),
      next_id_(other.next_id_) {}

ControlServer::~ControlServer() {
  for (const Client& client : clients_) ::close(client.fd);
  if (listen_fd_ < 0) return;
  ::close(listen_fd_);
  ::unlink(socket_.c_str());
}

/// Accepts all waiting clients and reads what they sent, both without blocking. Only the first line
/// of a client is its request; the connection stays open until answer(), or until the client closes
/// it.
std::vector<ControlServer::Request> ControlServer::poll() {
  for (int fd = 0;
       (fd = ::accept4(listen_fd_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)) >= 0;) {
    clients_.push_back({.id = next_id_++, .fd = fd});
  }
  std::vector<Request> requests;
  for (Client& client : clients_) {
    std::array<char, 4096> buffer;
    ssize_t n = 0;
    while ((n = ::recv(client.fd, buffer.data(), buffer.size(), MSG_DONTWAIT)) > 0 &&
           client.input.size() <= kMaxLine) {
      client.input.append(buffer.data(), static_cast<std::size_t>(n));
    }
    // A read of 0 bytes is the client's end of file; EAGAIN only means that nothing has arrived
    // yet.
    const bool gone = n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR);
    const std::size_t end = client.input.find('\n');
    // A complete request is served even if its sender has closed its side: the command may be a
    // stop.
    if (!client.asked && end <= kMaxLine) {
      client.asked = true;
      requests.push_back({client.id, client.input.substr(0, end)});
      client.input.clear();  // what follows is no request and does not count as a long line
      continue;
    }
    if (client.input.size() > kMaxLine) {
      send_line(client.fd, "failed: the line is too long");
    } else if (!gone) {
      continue;
    }
    ::close(std::exchange(client.fd, -1));
  }
  std::erase_if(clients_, [](const Client& c) { return c.fd < 0; });
  return requests;
}

void ControlServer::answer(ClientId id, const std::string& text) {
  const auto client =
      std::find_if(clients_.begin(), clients_.end(), [&](const Client& c) { return c.id == id; });
  if (client == clients_.end()) return;  // the client left before the answer
  send_line(client->fd, text);
  ::close(client->fd);
  clients_.erase(client);
}

bool launcher_listens(const std::filesystem::path& run_dir) {
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return false;
  const ShortAddress address(run_dir);
  // EAGAIN: one that hangs has a full queue.
  const bool listens = ::connect(fd, address.get(), sizeof(sockaddr_un)) == 0 || errno == EAGAIN;
  ::close(fd);
  return listens;
}

/// Blocks until the launcher closes the connection, which it does after the last line of its
/// answer. The result is decided by that last line.
Result<bool> send_command(const std::filesystem::path& run_dir, const std::string& line,
                          const std::function<void(const std::string&)>& on_line,
                          const std::function<bool()>& on_wait) {
  // Not blocking: a launcher that hangs does not accept, and its queue may be full.
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const ShortAddress address(run_dir);
  if (::connect(fd, address.get(), sizeof(sockaddr_un)) != 0) {
    const int error = errno;
    ::close(fd);
    return fail(ErrorCode::kEnvironment, fmt::format("no mission is running in {}: {}",
                                                     run_dir.string(), std::strerror(error)));
  }
  const std::string text = line + "\n";
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t n = ::send(fd, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
    if (n <= 0) break;  // the server closed early: its answer, read below, gives the reason
    sent += static_cast<std::size_t>(n);
  }
  std::string input;
  std::string last;
  // The answer may arrive in pieces of any length; each complete line is passed on at once.
  const SteadyTime until = std::chrono::steady_clock::now() + kAnswerTimeout;
  while (std::chrono::steady_clock::now() < until && (!on_wait || on_wait())) {
    pollfd waiting{.fd = fd, .events = POLLIN, .revents = 0};
    const int ready = ::poll(&waiting, 1, kWait_ms);
    if (ready < 0 && errno != EINTR) break;
    if (ready <= 0) continue;
    std::array<char, 4096> buffer;
    const ssize_t n = ::recv(fd, buffer.data(), buffer.size(), 0);
    if (n <= 0) break;
    input.append(buffer.data(), static_cast<std::size_t>(n));
    for (std::size_t end = 0; (end = input.find('\n')) != std::string::npos;
         input.erase(0, end + 1)) {
      last = input.substr(0, end);
      on_line(last);
    }
  }
  ::close(fd);
  if (last.empty()) return fail(ErrorCode::kEnvironment, "the launcher did not answer");
  return last.starts_with("done");
}

}  // namespace swarm::shell
