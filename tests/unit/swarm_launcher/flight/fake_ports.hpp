// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "swarm_launcher/flight/flight_ports.hpp"

namespace swarm::launcher {

/// A process that was started, without the process.
struct FakeChild {
  pid_t pid = 0;
  std::vector<std::string> line;
  bool runs = true;
  std::vector<EndSignal> signals{};

  /// The value that follows an option of its command line; empty: it is not there.
  std::string option(const std::string& name) const {
    const auto at = std::find(line.begin(), line.end(), name);
    return at == line.end() || at + 1 == line.end() ? "" : *(at + 1);
  }
  bool is_planner() const { return line.front() == "planner"; }
  std::uint32_t first_robot() const {
    return static_cast<std::uint32_t>(std::stoul(option("--ids")));
  }
};

class FakeSpawner final : public Spawner {
 public:
  Result<pid_t> start(const std::vector<std::string>& command_line,
                      const std::filesystem::path&) override {
    if (children.size() == starts_left) return fail(ErrorCode::kEnvironment, "no process left");
    children.push_back({.pid = 1000 + static_cast<pid_t>(children.size()), .line = command_line});
    return children.back().pid;
  }

  std::optional<ExitedChild> reap() override {
    if (ended_.empty()) return std::nullopt;
    const ExitedChild child = ended_.front();
    ended_.pop_front();
    return child;
  }

  void signal(pid_t pid, EndSignal signal) override {
    for (FakeChild& child : children) {
      if (child.pid != pid) continue;
      child.signals.push_back(signal);
      if (obedient || signal == EndSignal::kKill) end(child, {});
    }
  }

  /// The process ends by itself or by a crash.
  void end(FakeChild& child, ProcessExit exit) {
    if (!child.runs) return;
    child.runs = false;
    end_other(child.pid, exit);
  }
  /// A child that the flight loop did not start ends.
  void end_other(pid_t pid, ProcessExit exit) {
    ended_.push_back({.pid = pid, .exit = exit, .cpu_s = 0.5, .max_rss_mb = 12.0});
  }

  /// The process that runs now.
  FakeChild& planner() {
    return running([](const FakeChild& child) { return child.is_planner(); });
  }
  FakeChild& agent(std::uint32_t robot) {
    return running([&](const FakeChild& child) {
      return !child.is_planner() && child.first_robot() == robot;
    });
  }
  std::size_t count_running() const {
    return static_cast<std::size_t>(
        std::count_if(children.begin(), children.end(), [](const auto& c) { return c.runs; }));
  }

  std::deque<FakeChild> children;  ///< all that were ever started, in their order
  bool obedient = true;            ///< they end at the first signal, otherwise by SIGKILL only
  std::size_t starts_left = 100;

 private:
  template <class Condition>
  FakeChild& running(const Condition& condition) {
    const auto found = std::find_if(children.begin(), children.end(), [&](const FakeChild& child) {
      return child.runs && condition(child);
    });
    return found != children.end() ? *found : throw std::logic_error("no such process runs");
  }

  std::deque<ExitedChild> ended_;  ///< not reaped yet
};

/// A control socket without the socket.
class FakeRequests final : public ControlRequests {
 public:
  std::vector<Request> poll() override { return std::exchange(waiting_, {}); }
  void answer(ClientId client, const std::string& text) override { answers_[client] = text; }

  ClientId send(const std::string& line) {
    waiting_.push_back({.client = next_, .line = line});
    return next_++;
  }
  /// Empty: not answered yet.
  std::string answer_to(ClientId client) const {
    const auto found = answers_.find(client);
    return found == answers_.end() ? "" : found->second;
  }

 private:
  std::vector<Request> waiting_;
  std::map<ClientId, std::string> answers_;
  ClientId next_ = 0;
};

/// One helper process.
class FakeHelpers final : public HelperProcesses {
 public:
  static constexpr pid_t kPid = 77;

  std::optional<LogEvent> on_exit(pid_t pid, SteadyTime) override {
    if (pid != kPid) return std::nullopt;
    return LogEvent{.warning = true, .code = "monitor-exit", .text = "the monitor ended"};
  }
  std::vector<LogEvent> step(SteadyTime) override { return std::exchange(next_events, {}); }
  std::optional<std::string> message() override { return std::exchange(next_message, {}); }
  std::uint32_t robots_of_gateway() const override { return by_gateway; }

  std::uint32_t by_gateway = 0;  ///< robots that it receives
  std::optional<std::string> next_message;
  std::vector<LogEvent> next_events;
};

class FakeDisplay final : public Display {
 public:
  void show(const std::string& headline, const std::string&) override {
    ++shown;
    if (headlines.empty() || headlines.back() != headline) headlines.push_back(headline);
  }
  void print(const std::string& line) override { printed += line + "\n"; }

  int shown = 0;
  std::vector<std::string> headlines;  ///< without repetitions
  std::string printed;
};

}  // namespace swarm::launcher
