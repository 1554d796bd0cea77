// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/hosts/remote_hosts.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "swarm_core/blackbox/blackbox_file.hpp"

namespace swarm::launcher {
namespace {

constexpr std::size_t kMaxHosts = 256;
constexpr std::uint64_t kMaxBoxBytes = 1ULL << 30U;
constexpr Duration kLostAfter = std::chrono::seconds(30);

std::string describe(std::uint32_t first_robot, std::uint32_t robots) {
  return fmt::format("host of robots {}-{}", first_robot, first_robot + robots - 1);
}

}  // namespace

void RemoteHosts::on_status(RobotId robot, SteadyTime now) {
  for (Host& host : hosts_) {
    if (robot.value() - host.first_robot < host.robots) host.watch.on_status(now);
  }
}

/// The next robots that are nobody's yet, at most as many as it wants.
void RemoteHosts::answer(Host& host, std::uint32_t robots) {
  const std::uint32_t per = offer_.per_process;
  const std::uint32_t wanted = (std::min(robots, offer_.robots) + per - 1) / per * per;
  const std::uint32_t given = std::min(wanted, offer_.robots - given_);
  if (begun_ || given == 0) {
    host.socket.send(nlohmann::json{
        {"refused", begun_ ? "the mission has begun" : "it has all the robots it needs"}}
                         .dump());
    return;
  }
  HostOffer part = offer_;
  part.first_robot = host.first_robot = offer_.first_robot + given_;
  part.robots = host.robots = given;
  part.first_process = offer_.first_process + given_ / per;
  host.first_process = ProcessIndex(1 + part.first_process);
  host.processes = (given + per - 1) / per;
  host.watch = HostWatch(given);
  given_ += given;
  joined_.push_back(static_cast<std::size_t>(&host - hosts_.data()));
  host.socket.send(to_line(part));
}

/// False if it is no line of a host that joins.
bool RemoteHosts::take_line(Host& host, const std::string& line) {
  const auto json = nlohmann::json::parse(line, nullptr, false);
  if (!json.is_object()) return false;
  if (const auto join = json.find("join"); join != json.end() && host.robots == 0) {
    if (!join->is_number_unsigned() || *join == 0U) return false;
    answer(host, static_cast<std::uint32_t>(
                     std::min<std::uint64_t>(join->get<std::uint64_t>(), offer_.robots)));
    return true;
  }
  if (host.robots == 0) return false;
  if (json.contains("over")) {
    host.over = true;
    return true;
  }
  if (json.contains("bye")) {
    host.left = host.over = true;
    return true;
  }
  const auto robot = json.value<std::uint32_t>("box", offer_.first_robot + offer_.robots);
  const auto bytes = json.value<std::uint64_t>("bytes", kMaxBoxBytes + 1);
  if (robot - host.first_robot >= host.robots || bytes > kMaxBoxBytes) return false;
  host.box =
      std::ofstream(blackbox::file_of(dir_, RobotId(robot)), std::ios::binary | std::ios::trunc);
  host.box_bytes = bytes;
  ++host.boxes;
  return host.box.good();
}

void RemoteHosts::take(Host& host) {
  host.socket.flush();
  host.socket.receive();
  while (!host.left) {
    if (host.box_bytes > 0) {
      const std::string bytes = host.socket.bytes(host.box_bytes);
      if (bytes.empty()) break;
      host.box.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
      host.box_bytes -= bytes.size();
      if (host.box_bytes == 0) host.box.close();
      continue;
    }
    const auto line = host.socket.line();
    if (!line) break;
    bool fits = false;
    try {
      fits = take_line(host, *line);
    } catch (const nlohmann::json::exception&) {
      // a field of another type than it should be
    }
    if (!fits) drop(host);
  }
  if (host.socket.gone()) drop(host);
}

void RemoteHosts::drop(Host& host) { host.left = host.over = true; }

std::vector<LogEvent> RemoteHosts::step(Supervisor& supervisor, SteadyTime now) {
  begun_ = supervisor.stage() > Supervisor::Stage::kGathering;
  while (hosts_.size() < kMaxHosts) {
    auto socket = server_.accept();
    if (!socket) break;
    hosts_.push_back({.socket = std::move(*socket)});
  }
  std::vector<LogEvent> log;
  bool cut = false;
  for (Host& host : hosts_) {
    const bool was_over = host.over;
    if (!host.left) take(host);
    if (host.robots == 0 || was_over) continue;
    const std::string who = describe(host.first_robot, host.robots);
    const auto change = host.watch.step(now);
    if (change && !host.over) {
      const bool lost_it = *change == HostWatch::Change::kCut;
      log.push_back(
          {.warning = lost_it,
           .code = lost_it ? "host-silent" : "host-back",
           .text = who + (lost_it ? " is not heard: the others pause" : " is heard again")});
    }
    if (host.watch.silence(now) > kLostAfter) drop(host);
    cut = cut || (host.watch.cut() && !host.over);
    if (!host.over) continue;
    for (std::uint32_t i = 0; i < host.processes; ++i) {
      supervisor.on_exit(ProcessIndex(host.first_process.value() + i), {}, now);
    }
    log.push_back({.warning = begun_ && supervisor.stage() == Supervisor::Stage::kRunning,
                   .code = "host-over",
                   .text = who + " has ended"});
  }
  for (const std::size_t i : std::exchange(joined_, {})) {
    const Host& host = hosts_[i];
    supervisor.on_joined(host.first_process, host.processes, now);
    log.push_back({.code = "host-joined", .text = describe(host.first_robot, host.robots)});
  }
  if (cut && supervisor.phase() == MissionPhase::kRunning) {
    supervisor.on_command(CommandKind::kPause, now);
    paused_ = true;
  } else if (!cut && paused_ && supervisor.phase() == MissionPhase::kPaused) {
    supervisor.on_command(CommandKind::kResume, now);
    paused_ = false;
  }
  return log;
}

void RemoteHosts::end(ProcessIndex process, EndSignal signal) {
  for (Host& host : hosts_) {
    if (process.value() - host.first_process.value() >= host.processes) continue;
    if (static_cast<int>(signal) <= host.told) return;
    host.told = static_cast<int>(signal);
    host.socket.send(nlohmann::json{{"end", host.told}}.dump());
    if (signal == EndSignal::kKill) host.over = true;  // whether it hears it or not
    return;
  }
}

bool RemoteHosts::collect() {
  bool all = true;
  for (Host& host : hosts_) {
    if (host.robots == 0 || host.left) continue;
    take(host);
    all = all && host.left;
  }
  return all;
}

std::uint32_t RemoteHosts::missing_boxes() const {
  std::uint32_t missing = 0;
  for (const Host& host : hosts_) missing += host.robots - std::min(host.robots, host.boxes);
  return missing;
}

}  // namespace swarm::launcher
