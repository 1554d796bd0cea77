// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "swarmflow/core/result.hpp"

/// `swarm_launcher command` talks to the launcher of a run through a Unix socket in the run
/// directory: the launcher is matched with every agent already, so a stop goes out at once.
/// Line-based: the client sends one line, a word and its arguments; the server answers with lines
/// of text; the last starts with "done" or "failed".
namespace swarm::shell {

class ControlServer {
 public:
  static Result<ControlServer> listen(const std::filesystem::path& run_dir);
  ControlServer(ControlServer&& other) noexcept;
  ControlServer& operator=(ControlServer&&) = delete;
  ~ControlServer();

  using ClientId = std::uint32_t;
  struct Request {
    ClientId client = 0;
    std::string line{};
  };

  /// What was asked since the last call; never blocks. Every request is to be answered. A line that
  /// is too long is answered with "failed" and dropped.
  std::vector<Request> poll();

  /// Sends the last line, or lines, of an answer and lets the client go.
  void answer(ClientId client, const std::string& text);

 private:
  ControlServer() = default;
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

/// Sends a line and hands every line of the answer to `on_line`. True when the last one says
/// "done".
Result<bool> send_command(const std::filesystem::path& run_dir, const std::string& line,
                          const std::function<void(const std::string&)>& on_line);

}  // namespace swarm::shell
