// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "swarm_core/base/result.hpp"
#include "swarm_core/mission/phase.hpp"

/// `swarm_launcher command` talks to the launcher of a run through a Unix socket in the run
/// directory: the launcher is matched with every agent already, so a stop goes out at once.
/// Line-based: the client sends one command word, the server answers with lines of text; the last
/// starts with "done" or "failed".
namespace swarm::launcher {

class ControlServer {
 public:
  static Result<ControlServer> listen(const std::filesystem::path& run_dir);
  ControlServer(ControlServer&& other) noexcept;
  ControlServer& operator=(ControlServer&&) = delete;
  ~ControlServer();

  /// Commands that arrived since the last call; never blocks. What is not a command is answered
  /// with "failed" and dropped.
  std::vector<CommandKind> poll();

  /// Sends a line to every waiting client; with `last` they are let go.
  void answer(const std::string& line, bool last);
  bool has_clients() const { return !clients_.empty(); }

 private:
  ControlServer() = default;
  struct Client {
    int fd = -1;
    std::string input;
    bool asked = false;
  };
  int listen_fd_ = -1;
  std::filesystem::path socket_;
  std::vector<Client> clients_;
};

/// Sends a command and hands every answer line to `on_line`. True when the last one says "done".
Result<bool> send_command(const std::filesystem::path& run_dir, CommandKind kind,
                          const std::function<void(const std::string&)>& on_line);

}  // namespace swarm::launcher
