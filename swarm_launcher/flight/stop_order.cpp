// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/stop_order.hpp"

#include <utility>

namespace swarm::launcher {
namespace {

constexpr Duration kBurst = std::chrono::milliseconds(500);  // a datagram at every step
constexpr Duration kRepeat = std::chrono::milliseconds(50);
constexpr std::uint32_t kMaxRobots = 200'000;  // an invented id must not take all memory

}  // namespace

StopOrder::StopOrder(std::unique_ptr<link::StopSender> sender, std::optional<std::uint32_t> robots)
    : sender_(std::move(sender)), robots_(robots) {}

void StopOrder::step(SteadyTime now, UtcTime utc_now) {
  if (!begin_) {
    begin_ = next_ = now;
    stamp_utc_ns_ = utc_now.time_since_epoch().count();
  }
  if (now >= next_) {
    sender_->send({.kind = CommandKind::kStop,
                   .command_id = static_cast<std::uint64_t>(stamp_utc_ns_),
                   .stamp_utc_ns = stamp_utc_ns_});
    if (now - *begin_ >= kBurst) next_ = now + kRepeat;
  }
  newly_.clear();
  received_.clear();
  sender_->take(received_);
  for (const link::StopConfirmation& some : received_) {
    if (some.command_id != static_cast<std::uint64_t>(stamp_utc_ns_)) continue;  // of another stop
    const std::uint64_t end = std::uint64_t{some.first_robot_id} + some.robots;
    if (end > robots_.value_or(kMaxRobots)) continue;  // of no robot of the run
    if (has_confirmed_.size() < end) has_confirmed_.resize(end);
    for (std::uint64_t id = some.first_robot_id; id < end; ++id) {
      if (has_confirmed_[id]) continue;
      has_confirmed_[id] = true;
      newly_.emplace_back(static_cast<std::uint32_t>(id));
      ++confirmed_;
    }
  }
}

std::vector<RobotId> StopOrder::unconfirmed() const {
  std::vector<RobotId> out;
  for (std::uint32_t id = 0; id < robots_.value_or(0); ++id) {
    if (id >= has_confirmed_.size() || !has_confirmed_[id]) out.emplace_back(id);
  }
  return out;
}

}  // namespace swarm::launcher
