// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "swarmflow/core/result.hpp"

/// `swarm_launcher command` sends commands to the launcher of a run through a Unix socket in the
/// run directory. The launcher's DDS endpoints are matched with those of every agent already, so a
/// stop goes out without discovery. The protocol is line-based: the client sends one line, a
/// command and its arguments; the server answers with lines of text, the last of which starts with
/// "done" or "failed".
namespace swarm::shell {

/// The launcher's end of the socket; single-threaded, polled by the launcher's loop. Only the user
/// who runs the mission can connect.
class ControlServer {
 public:
  /// Makes the socket `control.sock` in a run directory. kEnvironment if that is not possible.
  static Result<ControlServer> listen(const std::filesystem::path& run_dir);
  ControlServer(ControlServer&& other) noexcept;
  ControlServer& operator=(ControlServer&&) = delete;
  ~ControlServer();

  /// Number of a connection, in the order in which connections were accepted.
  using ClientId = std::uint32_t;
  /// A line that a client sent, without its newline.
  struct Request {
    ClientId client = 0;
    std::string line{};
  };

  /// The requests since the last call; never blocks. The caller must answer() each of them. A line
  /// that is too long is answered with "failed" and dropped.
  std::vector<Request> poll();

  /// Sends the last line, or lines, of an answer and closes the connection.
  void answer(ClientId client, const std::string& text);

 private:
  ControlServer() = default;
  /// A connection: what was received so far, and whether its request was returned by poll().
  struct Client {
    ClientId id = 0;
    int fd = -1;
    std::string input{};
    bool asked = false;
  };
  int listen_fd_ = -1;
  std::filesystem::path socket_;
  std::vector<Client> clients_;
  ClientId next_id_ = 0;
};

/// Whether a launcher listens in a run directory.
bool launcher_listens(const std::filesystem::path& run_dir);

/// Sends a line and calls `on_line` for every line of the answer, and `on_wait`, if there is one,
/// every 20 ms meanwhile; it returns false to give up waiting. Waits 15 s at most. True when the
/// last line starts with "done"; kEnvironment if no launcher listens or none answers.
Result<bool> send_command(const std::filesystem::path& run_dir, const std::string& line,
                          const std::function<void(const std::string&)>& on_line,
                          const std::function<bool()>& on_wait = {});

}  // namespace swarm::shell
