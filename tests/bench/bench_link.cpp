// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// CPU per delivered state: real processes that all receive each other at 10 Hz, by each channel and
// by plain UDP with a waiting thread, one after the other in one run. JSON on stdout.
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <arpa/inet.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "swarm_core/base/clock.hpp"
#include "swarm_link/channels/groups/group_channel.hpp"
#include "swarm_link/roles/join.hpp"

namespace {

using namespace swarm;
using namespace std::chrono_literals;

constexpr auto kPeriod = 100ms;
constexpr auto kWarmUp = 3s;
constexpr std::uint32_t kMaxProcesses = 1000;

struct Case {
  const char* name;
  std::uint32_t processes;
  std::uint32_t robots_each;
};

/// What child processes report to the parent, in shared memory.
struct Board {
  std::atomic<std::uint32_t> ready = 0;
  std::atomic<bool> go = false;
  struct Result {
    std::uint64_t delivered = 0;
    double cpu_s = 0.0;
  };
  std::array<Result, kMaxProcesses> results;
};

double cpu_s() {
  rusage used = {};
  ::getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

/// How one process sends and receives.
class Sender {
 public:
  virtual ~Sender() = default;
  /// Sends the states of this process. Returns how many states arrived since the last call.
  virtual std::uint64_t tick(std::span<const link::RobotStateMessage> states) = 0;
};

class ChannelSender final : public Sender {
 public:
  ChannelSender(std::unique_ptr<link::Participant> participant,
                std::unique_ptr<link::StateChannel> channel)
      : participant_(std::move(participant)), channel_(std::move(channel)) {}

  std::uint64_t tick(std::span<const link::RobotStateMessage> states) override {
    if (participant_) participant_->receive();
    received_.clear();
    channel_->take(received_);
    std::uint64_t delivered = 0;
    for (const auto& batch : received_) delivered += batch.states.size();
    channel_->publish(states);
    channel_->listen_around(places_);
    return delivered;
  }

 private:
  std::unique_ptr<link::Participant> participant_;
  std::unique_ptr<link::StateChannel> channel_;
  std::vector<Vec2> places_ = {{50.0, 50.0}};
  std::vector<link::CellStatesMessage> received_;
};

/// Plain UDP: one datagram to each peer, and a thread that waits for theirs.
class UdpSender final : public Sender {
 public:
  UdpSender(std::uint32_t self, std::uint32_t processes)
      : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    const sockaddr_in own = address_of(self);
    if (::bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0) {
      std::perror("bench_link: bind");
      std::_Exit(2);
    }
    for (std::uint32_t i = 0; i < processes; ++i) peers_.push_back(address_of(i));
    std::thread([this] {
      std::array<std::byte, 2048> bytes;
      while (::recv(socket_, bytes.data(), bytes.size(), 0) > 0) ++received_;
    }).detach();
  }

  std::uint64_t tick(std::span<const link::RobotStateMessage> states) override {
    const auto* bytes = states.data();
    for (const sockaddr_in& peer : peers_) {
      ::sendto(socket_, bytes, states.size_bytes(), 0, reinterpret_cast<const sockaddr*>(&peer),
               sizeof peer);
    }
    return received_.exchange(0);
  }

 private:
  static sockaddr_in address_of(std::uint32_t process) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(20'000 + process));
    return address;
  }
  int socket_;
  std::vector<sockaddr_in> peers_;
  std::atomic<std::uint64_t> received_ = 0;
};

template <class T>
T or_end(Result<T> made) {
  if (made) return std::move(*made);
  std::fprintf(stderr, "bench_link: %s\n", made.error().message.c_str());
  std::_Exit(2);
}

std::unique_ptr<Sender> make_sender(const Case& c, std::uint32_t self,
                                    const link::Meeting& meeting) {
  const std::string name = c.name;
  if (name.starts_with("udp")) return std::make_unique<UdpSender>(self, c.processes);
  if (name.starts_with("groups")) {
    link::GroupChannelOptions options{.domain = meeting.domain};
    options.cells.cell_size_m = 100.0;
    return std::make_unique<ChannelSender>(nullptr, or_end(link::make_group_channel(options)));
  }
  auto participant = or_end(link::join_as_agent(meeting, self, fmt::format("bench_{}", self)));
  auto channel = link::make_topic_channel(*participant, {.cell_size_m = 100.0});
  return std::make_unique<ChannelSender>(std::move(participant), std::move(channel));
}

[[noreturn]] void child(const Case& c, std::uint32_t self, const link::Meeting& meeting,
                        Duration measured, Board& board) {
  const auto sender = make_sender(c, self, meeting);
  std::vector<link::RobotStateMessage> states(c.robots_each);
  for (std::uint32_t i = 0; i < c.robots_each; ++i) {
    states[i] = {.robot_id = self * c.robots_each + i, .x_m = 50.0, .y_m = 50.0};
  }
  ++board.ready;
  while (!board.go) std::this_thread::sleep_for(1ms);
  auto next = std::chrono::steady_clock::now() + kPeriod * self / c.processes;
  const auto begin = next + kWarmUp;
  const auto end = begin + measured;
  bool counting = false;
  double cpu_before_s = 0.0;
  std::uint64_t delivered = 0;
  for (; next < end; next += kPeriod) {
    std::this_thread::sleep_until(next);
    if (!counting && next >= begin) {
      counting = true;
      cpu_before_s = cpu_s();
      delivered = 0;
    }
    for (auto& state : states) {
      ++state.sequence_number;
      state.stamp_utc_ns = utc_now().time_since_epoch().count();
    }
    delivered += sender->tick(states);
  }
  board.results[self] = {.delivered = delivered, .cpu_s = cpu_s() - cpu_before_s};
  std::_Exit(0);
}

/// Runs a case; µs of CPU per delivered state.
nlohmann::ordered_json run(const Case& c, std::uint32_t domain, Duration measured) {
  void* memory =
      ::mmap(nullptr, sizeof(Board), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) std::abort();
  Board& board = *new (memory) Board;
  link::Meeting meeting{.domain = domain};
  // The server runs in a process of its own: a library with threads must not be forked.
  std::array<int, 2> pipe{};
  if (::pipe(pipe.data()) != 0) std::abort();
  const pid_t server = ::fork();
  if (server == 0) {
    const auto made = or_end(link::make_discovery_server(domain, 0));
    const std::uint16_t port = made->address().port;
    if (::write(pipe[1], &port, sizeof port) != sizeof port) std::_Exit(2);
    for (;;) ::pause();
  }
  if (::read(pipe[0], &meeting.server.port, sizeof meeting.server.port) !=
      sizeof meeting.server.port) {
    std::abort();
  }
  std::vector<pid_t> children;
  for (std::uint32_t i = 0; i < c.processes; ++i) {
    const pid_t pid = ::fork();
    if (pid == 0) child(c, i, meeting, measured, board);
    children.push_back(pid);
    std::this_thread::sleep_for(20ms);
  }
  while (board.ready < c.processes) std::this_thread::sleep_for(10ms);
  board.go = true;
  for (const pid_t pid : children) ::waitpid(pid, nullptr, 0);
  ::kill(server, SIGKILL);
  ::waitpid(server, nullptr, 0);
  ::close(pipe[0]);
  ::close(pipe[1]);
  Board::Result all;
  for (std::uint32_t i = 0; i < c.processes; ++i) {
    all.delivered += board.results[i].delivered;
    all.cpu_s += board.results[i].cpu_s;
  }
  ::munmap(memory, sizeof(Board));
  const double expected = to_seconds(measured) * 10.0 * c.processes * c.processes * c.robots_each;
  return {{"case", c.name},
          {"processes", c.processes},
          {"robots_each", c.robots_each},
          {"delivered_share", static_cast<double>(all.delivered) / expected},
          {"us_per_state", 1e6 * all.cpu_s / static_cast<double>(all.delivered)}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("CPU per delivered state, by each channel and by plain UDP", "bench_link");
  double seconds = 5.0;
  std::uint32_t processes = 50, domain = 200, rounds = 3;
  app.add_option("--seconds", seconds, "Of each case");
  app.add_option("--processes", processes)->check(CLI::Range(2U, kMaxProcesses));
  app.add_option("--rounds", rounds, "Rounds, each of all cases in turn");
  app.add_option("--domain", domain, "DDS domain");
  CLI11_PARSE(app, argc, argv);

  const std::vector<Case> cases = {{"udp", processes, 1},
                                   {"topics", processes, 1},
                                   {"groups", processes, 1},
                                   {"topics packed", std::max(2U, processes / 5), 50},
                                   {"groups packed", std::max(2U, processes / 5), 50}};
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (std::uint32_t round = 0; round < rounds; ++round) {
    double udp_us = 0.0;
    for (const Case& c : cases) {
      auto row = run(c, domain, from_seconds(seconds));
      if (udp_us == 0.0) udp_us = row["us_per_state"];
      row["of_udp"] = row["us_per_state"].get<double>() / udp_us;
      std::fprintf(stderr, "%-14s %7.2f us  %5.2f of udp  %5.1f %% delivered\n", c.name,
                   row["us_per_state"].get<double>(), row["of_udp"].get<double>(),
                   100.0 * row["delivered_share"].get<double>());
      all.push_back(std::move(row));
    }
  }
  std::printf("%s\n", all.dump(2).c_str());
}
