// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/hosts/remote_hosts.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "swarm_core/base/clock.hpp"
#include "swarm_core/robot_log/robot_log_file.hpp"
#include "swarm_launcher/hosts/last_position.hpp"

namespace swarm::launcher {
namespace {

constexpr std::size_t kMaxHosts = 256;
constexpr std::size_t kMaxLine = 4096;  // of a host
// Bytes buffered per host while it sends its logs.
constexpr std::size_t kMaxHeld = 4U << 20U;
// Lines per step and host, so that one host cannot delay the launcher's loop.
constexpr int kLinesAtOnce = 64;
constexpr std::uint64_t kMaxLogBytes = 1ULL << 30U;
// As kMaxStatusRobots: a process with more robots sends several statuses per period.
constexpr std::uint32_t kRobotsPerStatus = 100;
constexpr Duration kRequestTimeout = std::chrono::seconds(10);

std::string describe(std::uint32_t first_robot, std::uint32_t robots) {
  return fmt::format("host of robots {}-{}", first_robot, first_robot + robots - 1);
}

/// A field that is a whole number from 0 to `most`.
std::optional<std::uint64_t> number(const nlohmann::json& json, const char* key,
                                    std::uint64_t most) {
  const auto field = json.find(key);
  if (field == json.end() || !field->is_number_unsigned()) return std::nullopt;
  const auto value = field->get<std::uint64_t>();
  return value <= most ? std::optional(value) : std::nullopt;
}

/// A field that is a text; empty if it is missing or something else.
std::string text(const nlohmann::json& json, const char* key) {
  const auto field = json.find(key);
  return field != json.end() && field->is_string() ? field->get<std::string>() : "";
}

/// Takes as long for a text that differs early as for one that differs late, so that a token cannot
/// be found character by character.
bool is_same(const std::string& a, const std::string& b) {
  unsigned difference = a.size() == b.size() ? 0U : 1U;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i % b.size()]);
  }
  return difference == 0;
}

}  // namespace

// The unsigned difference is out of range for robots below the first one as well.
void RemoteHosts::on_status(RobotId robot, SteadyTime now) {
  for (Host& host : hosts_) {
    if (robot.value() - host.first_robot < host.robots) host.watch.on_status(now);
  }
}

void RemoteHosts::on_user_command(CommandKind kind) {
  if (kind == CommandKind::kPause) paused_ = false;
}

// False: the connection is to be closed.
bool RemoteHosts::refuse(Host& host, const char* why) {
  host.socket.send(nlohmann::json{{"refused", why}}.dump());
  return false;
}

/// Assigns the next free robots, in whole processes and at most as many as requested, and sends the
/// offer. False if there are none.
bool RemoteHosts::answer(Host& host, std::uint32_t robots) {
  if (begun_ || free_.empty()) {
    return refuse(host, begun_ ? "the mission has begun" : "it has all the robots it needs");
  }
  const std::uint32_t per = offer_.per_process;
  Block& block = free_.front();
  const std::uint32_t given = std::min((robots + per - 1) / per * per, block.robots);
  HostOffer part = offer_;
  part.first_robot = host.first_robot = offer_.first_robot + block.first;
  part.robots = host.robots = given;
  part.first_process = offer_.first_process + block.first / per;
  host.first_process = ProcessIndex(1 + part.first_process);
  host.processes = (given + per - 1) / per;
  host.watch =
      HostWatch(host.processes * ((std::min(per, given) + kRobotsPerStatus - 1) / kRobotsPerStatus),
                times_, now_);
  block.first += given;
  block.robots -= given;
  if (block.robots == 0) free_.erase(free_.begin());
  joined_.push_back(static_cast<std::size_t>(&host - hosts_.data()));
  part.sent_at = utc_now();
  host.socket.send(to_line(part));
  return true;
}

/// A process of the host has ended: its number on the host, exit code, signal, and whether the host
/// restarts it.
bool RemoteHosts::take_exit(Host& host, const nlohmann::json& line) {
  const auto process = number(line, "exit", host.processes - 1);
  const auto code = number(line, "code", 255);
  const auto signal = number(line, "signal", 64);
  const auto restarts = line.find("restarts");
  if (!process || !code || !signal || restarts == line.end() || !restarts->is_boolean()) {
    return false;
  }
  const ProcessIndex index(host.first_process.value() + static_cast<std::uint32_t>(*process));
  host.exits.emplace_back(index, ProcessExit{.code = static_cast<int>(*code),
                                             .signal = static_cast<int>(*signal),
                                             .is_restarted = restarts->get<bool>()});
  return true;
}

/// Where one of its robots made its last step. A later stamp than now, by a clock that differs,
/// would outrank each status.
bool RemoteHosts::take_last(const Host& host, const nlohmann::json& line) {
  auto last = parse_last_position(line);
  if (!last || last->robot.value() - host.first_robot >= host.robots) return false;
  last->known.at = std::min(last->known.at, utc_now());
  last_known_.insert_or_assign(last->robot, last->known);
  return true;
}

std::optional<LastKnown> RemoteHosts::last_known(RobotId robot) const {
  const auto known = last_known_.find(robot);
  return known == last_known_.end() ? std::nullopt : std::optional(known->second);
}

/// The first line must be a request; then "exit" (a process has ended), "last" (where a robot
/// made its last step), "over" (all have ended), "box" (a robot log follows) and "bye". The peer is
/// not trusted: a log is accepted for its own robots only and up to a size limit.
bool RemoteHosts::take_line(Host& host, const std::string& line) {
  const auto json = nlohmann::json::parse(line, nullptr, false);
  if (!json.is_object()) return false;
  if (host.robots == 0) {
    const auto wanted = number(json, "join", 1'000'000);
    if (!wanted || *wanted == 0) return false;
    if (!token_.empty() && !is_same(text(json, "token"), token_)) {
      return refuse(host, "its --join-token is missing or wrong");
    }
    return answer(host,
                  static_cast<std::uint32_t>(std::min<std::uint64_t>(*wanted, offer_.robots)));
  }
  if (json.contains("exit")) return !host.over && take_exit(host, json);
  if (json.contains("last")) return take_last(host, json);
  if (json.contains("over")) {
    host.over = true;
    return true;
  }
  if (json.contains("bye")) {
    drop(host);
    return true;
  }
  const auto robot = number(json, "box", offer_.first_robot + offer_.robots);
  const auto bytes = number(json, "bytes", kMaxLogBytes);
  if (!robot || !bytes || *bytes == 0) return false;
  host.log_robot = static_cast<std::uint32_t>(*robot);
  if (host.log_robot - host.first_robot >= host.robots) return false;
  host.log_file = std::ofstream(robot_log::file_of(dir_, RobotId(host.log_robot)),
                                std::ios::binary | std::ios::trunc);
  host.log_bytes = *bytes;
  return host.log_file.good();
}

// Writes bytes to the file as they arrive. A log counts as collected only when it is complete.
void RemoteHosts::take_log(Host& host) {
  const std::string bytes = host.socket.bytes(host.log_bytes);
  host.log_file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  host.log_bytes -= bytes.size();
  if (host.log_bytes > 0) return;
  host.log_file.close();
  if (host.log_file.good()) collected_[host.log_robot - offer_.first_robot] = true;
}

// Lines and the bytes of a log alternate on the connection; what follows depends on log_bytes. A
// connection without a request may buffer little.
void RemoteHosts::take(Host& host) {
  host.socket.flush();
  host.socket.receive(host.robots > 0 ? kMaxHeld : kMaxLine);
  for (int lines = 0; !host.left && lines < kLinesAtOnce; ++lines) {
    if (host.log_bytes > 0) {
      take_log(host);
      if (host.log_bytes > 0) break;
      continue;
    }
    const auto line = host.socket.line(kMaxLine);
    if (!line) break;
    if (!take_line(host, *line)) drop(host);
  }
  if (host.socket.gone()) drop(host);
}

/// Closes the connection. The host treats this as a request to end and ends its robots.
void RemoteHosts::drop(Host& host) {
  host.left = host.over = true;
  host.socket.close();
}

std::vector<LogEvent> RemoteHosts::step(Supervisor& supervisor, SteadyTime now) {
  begun_ = supervisor.stage() > Supervisor::Stage::kGathering;
  // Suspended itself, the launcher could not receive them.
  constexpr Duration kOwnGap = std::chrono::seconds(1);
  if (now_ != SteadyTime{} && now - now_ > kOwnGap) {
    for (Host& host : hosts_) host.watch.restart(now);
  }
  now_ = now;
  // Connections that never requested robots are forgotten, and before the start those that left.
  std::erase_if(hosts_, [this](const Host& host) {
    return host.left && (host.robots == 0 || (host.counted && !begun_));
  });
  while (hosts_.size() < kMaxHosts) {
    auto socket = server_.accept();
    if (!socket) break;
    hosts_.push_back({.socket = std::move(*socket), .came = now});
  }
  std::vector<LogEvent> log;
  for (Host& host : hosts_) {
    if (!host.left) take(host);
    if (host.robots == 0 && now - host.came > kRequestTimeout) drop(host);
  }
  // Reported after all connections were read, because take() runs without the supervisor.
  for (const std::size_t i : std::exchange(joined_, {})) {
    const Host& host = hosts_[i];
    supervisor.on_joined(host.first_process, host.processes, now);
    log.push_back({.code = "host-joined", .text = describe(host.first_robot, host.robots)});
  }
  cut_ = false;
  for (Host& host : hosts_) {
    if (host.robots == 0 || host.counted) continue;
    report_exits(host, supervisor, now);
    watch(host, supervisor, now, log);
  }
  pause_or_resume(cut_, supervisor, now);
  return log;
}

// A process may end again before the last step, so that the order counts. One that is restarted has
// another sender.
void RemoteHosts::report_exits(Host& host, Supervisor& supervisor, SteadyTime now) {
  for (const auto& [process, exit] : std::exchange(host.exits, {})) {
    if (host.gone.contains(process)) continue;
    if (!exit.is_restarted) host.gone.insert(process);
    supervisor.on_exit(process, exit, now);
    ended_.push_back(process);
  }
}

// Reachability of a host. A host that is over counts as ended processes; before the start its
// robots become free for another host.
void RemoteHosts::watch(Host& host, Supervisor& supervisor, SteadyTime now,
                        std::vector<LogEvent>& log) {
  const std::string who = describe(host.first_robot, host.robots);
  const auto change = host.watch.step(now);
  if (change && !host.over) {
    const bool lost_it = *change == HostWatch::Change::kCut;
    log.push_back(
        {.warning = lost_it,
         .code = lost_it ? "host-silent" : "host-back",
         .text = who + (lost_it ? " is not received: the others pause" : " is received again")});
  }
  if (!host.over && host.watch.lost(now)) {
    if (!host.watch.was_received()) {
      log.push_back({.warning = true,
                     .code = "host-absent",
                     .text = who + " has joined, but its robots send no status: it is dropped"});
    }
    drop(host);
  }
  cut_ = cut_ || (host.watch.cut() && !host.over);
  if (!host.over) return;
  host.counted = true;
  for (std::uint32_t i = 0; i < host.processes; ++i) {
    const ProcessIndex process(host.first_process.value() + i);
    if (host.gone.contains(process)) continue;
    ended_.push_back(process);
    supervisor.on_exit(process, {}, now);
  }
  if (!begun_) make_free({host.first_robot - offer_.first_robot, host.robots});
  log.push_back({.warning = supervisor.stage() != Supervisor::Stage::kEnding,
                 .code = "host-over",
                 .text = who + " has ended"});
}

/// Adjacent blocks become one again.
void RemoteHosts::make_free(const Block& block) {
  free_.push_back(block);
  std::ranges::sort(free_, {}, &Block::first);
  std::vector<Block> joined;
  for (const Block& next : free_) {
    if (!joined.empty() && joined.back().first + joined.back().robots == next.first) {
      joined.back().robots += next.robots;
    } else {
      joined.push_back(next);
    }
  }
  free_ = std::move(joined);
}

/// Pauses once per cut. If the user resumes during a cut, the mission is not paused again until the
/// host was back and is cut off again.
void RemoteHosts::pause_or_resume(bool cut, Supervisor& supervisor, SteadyTime now) {
  if (paused_ && supervisor.phase() == MissionPhase::kRunning) {
    paused_ = false;
    overruled_ = cut;
  }
  overruled_ = overruled_ && cut;
  if (cut && !overruled_ && supervisor.phase() == MissionPhase::kRunning) {
    supervisor.on_command(CommandKind::kPause, now);
    paused_ = true;
  } else if (!cut && paused_) {
    supervisor.on_command(CommandKind::kResume, now);
    paused_ = false;
  }
}

// Only a signal stronger than the last one is sent. After a kill the launcher does not wait for the
// host.
void RemoteHosts::end(ProcessIndex process, EndSignal signal) {
  for (Host& host : hosts_) {
    if (process.value() - host.first_process.value() >= host.processes || host.counted) continue;
    if (static_cast<int>(signal) <= host.signalled) return;
    host.signalled = static_cast<int>(signal);
    host.socket.send(nlohmann::json{{"end", host.signalled}}.dump());
    if (signal == EndSignal::kKill) host.over = true;  // even if the line does not arrive
    return;
  }
}

// Done when every host has left, with or without its logs.
bool RemoteHosts::collect() {
  bool all = true;
  for (Host& host : hosts_) {
    if (host.robots == 0 || host.left) continue;
    take(host);
    all = all && host.left;
  }
  return all;
}

std::uint32_t RemoteHosts::missing_logs() const {
  std::uint32_t missing = 0;
  for (const Host& host : hosts_) {
    for (std::uint32_t i = 0; i < host.robots; ++i) {
      missing += collected_[host.first_robot - offer_.first_robot + i] ? 0 : 1;
    }
  }
  return missing;
}

}  // namespace swarm::launcher
