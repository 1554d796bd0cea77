// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/system/hostile/intruder.hpp"

#include <algorithm>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "swarm_core/base/clock.hpp"
#include "swarm_link/adapters/cyclone/cyclone_participant.hpp"
#include "swarm_link/adapters/fastdds/fastdds_participant.hpp"
#include "swarm_link/cdr/codec.hpp"
#include "swarm_link/channels/groups/group_channel.hpp"
#include "swarm_link/udp_socket.hpp"
#include "tests/system/hostile/udp_ports.hpp"

namespace swarm::test {
namespace {

using namespace swarm::link;

}  // namespace

std::int64_t utc_ns() { return utc_now().time_since_epoch().count(); }

Result<std::unique_ptr<Participant>> intrude(const FlownRun& flown) {
  const auto info = shell::read_run_info(flown.dir());
  if (!info) return tl::unexpected(info.error());
  const shell::RunInfo& run = *info;
  if (run.channel == Channel::kTopics) {
    return make_fastdds_participant({.name = "hostile",
                                     .domain = run.domain,
                                     .index = 60,
                                     .discovery = {run.discovery_host, run.discovery_port}});
  }
  CycloneOptions options{.name = "hostile", .domain = run.domain};
  options.peer_ports = udp_ports_of(flown.launcher().pid());
  for (const Child& child : children_of(flown.launcher().pid())) {
    const auto ports = udp_ports_of(child.pid);
    options.peer_ports.insert(options.peer_ports.end(), ports.begin(), ports.end());
  }
  return make_cyclone_participant(options);
}

Intruder::Intruder(const FlownRun& run) {
  run_ = shell::read_run_info(run.dir()).value();
  auto joined = intrude(run);
  if (!joined) {
    ADD_FAILURE() << joined.error().message;
    return;
  }
  participant_ = std::move(*joined);
  Participant& p = *participant_;
  writers_ = {p.make_writer(plan_topic()).value(),      p.make_writer(scene_topic()).value(),
              p.make_writer(heartbeat_topic()).value(), p.make_writer(command_topic()).value(),
              p.make_writer(status_topic()).value(),    p.make_writer(event_topic()).value(),
              p.make_writer(cell_topic({0, 0})).value()};
  heartbeats_ = p.make_reader(heartbeat_topic()).value();
  statuses_ = p.make_reader(status_topic()).value();
  commands_ = p.make_reader(command_topic()).value();
  if (run_.channel == Channel::kGroups) group_socket_ = open_group_sender(to_in_addr(kLoopback));
}

Intruder::~Intruder() {
  if (group_socket_ >= 0) ::close(group_socket_);
}

bool Intruder::is_in(int agents) {
  if (!participant_) return false;
  look();
  const Writers& w = writers_;
  return w.plan->matched() >= agents && w.scene->matched() > agents &&
         w.heartbeat->matched() > agents && w.command->matched() > agents &&
         w.status->matched() >= 2 && w.event->matched() >= 1 && epoch_ != 0 &&
         command_.command_id != 0 && std::ssize(modes_) >= agents;
}

bool Intruder::write(const conformance::AnyMessage& message) {
  has_written_ = true;
  return std::visit(
      [this](const auto& m) {
        using M = std::decay_t<decltype(m)>;
        if constexpr (std::is_same_v<M, PlanMessage>) return writers_.plan->write(m);
        if constexpr (std::is_same_v<M, SceneMessage>) return writers_.scene->write(m);
        if constexpr (std::is_same_v<M, HeartbeatMessage>) return writers_.heartbeat->write(m);
        if constexpr (std::is_same_v<M, CommandMessage>) return writers_.command->write(m);
        if constexpr (std::is_same_v<M, StatusMessage>) return writers_.status->write(m);
        if constexpr (std::is_same_v<M, EventMessage>) return writers_.event->write(m);
        if constexpr (std::is_same_v<M, CellStatesMessage>) return write(m);
      },
      message);
}

/// To the groups of all cells of the yard that robots may be in, whatever the states are.
bool Intruder::write(const CellStatesMessage& batch) {
  if (!writers_.cell->write(batch)) return false;
  std::vector<std::byte> payload, datagram;
  if (group_socket_ < 0 || !encode(batch, payload)) return true;
  constexpr GuidPrefix kPrefix{'h', 'o', 's', 't', 'i', 'l', 'e'};
  encode_rtps(kPrefix, ++datagrams_, payload, datagram);
  for (std::int32_t x = 0; x < 8; ++x) {
    for (std::int32_t y = 0; y < 6; ++y) {
      const GroupAddress address = group_address(run_.domain, {x, y});
      sockaddr_in to{};
      to.sin_family = AF_INET;
      to.sin_port = htons(address.port);
      to.sin_addr = to_in_addr(address.host);
      ::sendto(group_socket_, datagram.data(), datagram.size(), 0,
               reinterpret_cast<const sockaddr*>(&to), sizeof to);
    }
  }
  return true;
}

/// What the intruder wrote comes back to it: only those count that it received before it wrote.
template <class M>
std::vector<M> Intruder::take_from_others(link::Reader<M>& reader) {
  std::vector<M> messages;
  std::vector<std::uint64_t> senders;
  reader.take_with_senders(messages, senders);
  if (!has_written_) others_.insert(senders.begin(), senders.end());
  std::vector<M> kept;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    if (others_.contains(senders[i])) kept.push_back(std::move(messages[i]));
  }
  return kept;
}

void Intruder::look() {
  if (!participant_) return;
  participant_->receive();
  for (const HeartbeatMessage& beat : take_from_others(*heartbeats_)) {
    epoch_ = beat.epoch;
    phase_ = beat.phase;
  }
  for (const StatusMessage& status : take_from_others(*statuses_)) {
    for (const RobotStatusMessage& robot : status.robots) modes_[robot.robot_id] = robot.mode;
  }
  for (const CommandMessage& command : take_from_others(*commands_)) command_ = command;
}

long Intruder::robots_in(RobotMode mode) const {
  return std::count_if(modes_.begin(), modes_.end(),
                       [&](const auto& robot) { return robot.second == mode; });
}

}  // namespace swarm::test
