// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "planner_service/program/planner_inbox.hpp"
#include "robot_agent/inbox.hpp"
#include "swarm_launcher/flight/health_inbox.hpp"
#include "swarm_link/cdr/codec.hpp"
#include "swarm_link/gateway/gateway_inbox.hpp"
#include "swarm_link/wire_bounds.hpp"
#include "swarm_monitor/view/swarm_state.hpp"
#include "tests/conformance/receivers/receiver.hpp"

namespace swarm::link::conformance {
namespace {

/// Messages published on a topic and not taken yet.
template <class M>
using Queue = std::shared_ptr<std::vector<M>>;

template <class M>
class QueueReader final : public Reader<M> {
 public:
  explicit QueueReader(Queue<M> queue) : queue_(std::move(queue)) {}
  std::size_t take(std::vector<M>& out) override {
    const std::size_t taken = queue_->size();
    out.insert(out.end(), queue_->begin(), queue_->end());
    queue_->clear();
    return taken;
  }
  int matched() const override { return 1; }
  std::uint64_t undecodable() const override { return 0; }

 private:
  Queue<M> queue_;
};

class QueueChannel final : public StateChannel {
 public:
  explicit QueueChannel(Queue<CellStatesMessage> queue) : reader_(std::move(queue)) {}
  std::size_t publish(std::span<const RobotStateMessage>) override { return 0; }
  void listen_around(std::span<const Vec2>) override {}
  bool receives_at(const Vec2&) const override { return true; }
  std::size_t take(std::vector<CellStatesMessage>& out) override { return reader_.take(out); }
  std::uint64_t undecodable() const override { return 0; }

 private:
  QueueReader<CellStatesMessage> reader_;
};

/// A receiver with one reader for each of these topics.
template <class... M>
class QueueReceiver : public Receiver {
 public:
  bool reads(const AnyMessage& message) const override {
    return (std::holds_alternative<M>(message) || ...);
  }
  bool publish(const AnyMessage& message, UtcTime now) override {
    ((push<M>(message)), ...);
    receive(now);
    return true;
  }

 protected:
  virtual void receive(UtcTime now) = 0;
  template <class Topic>
  ReaderPtr<Topic> reader() {
    return std::make_unique<QueueReader<Topic>>(queue<Topic>());
  }
  template <class Topic>
  const Queue<Topic>& queue() const {
    return std::get<Queue<Topic>>(queues_);
  }

 private:
  template <class Topic>
  void push(const AnyMessage& message) {
    if (const auto* m = std::get_if<Topic>(&message)) queue<Topic>()->push_back(*m);
  }
  std::tuple<Queue<M>...> queues_{std::make_shared<std::vector<M>>()...};
};

class AgentReceiver final : public QueueReceiver<PlanMessage, SceneMessage, HeartbeatMessage,
                                                 CommandMessage, CellStatesMessage> {
 public:
  explicit AgentReceiver(const Mission& mission)
      : channel_(queue<CellStatesMessage>()),
        inbox_(agent::Readers{reader<PlanMessage>(), reader<SceneMessage>(),
                              reader<HeartbeatMessage>(), reader<CommandMessage>()},
               channel_, wire_limits(mission), agent::MissionWatch(std::chrono::seconds(2)),
               std::chrono::seconds(2), mission.link.communication_radius_m) {}

  std::string state() override {
    const auto plan_time = inbox_.plan_time(kSteady);
    return fmt::format("plan {} {} scene {} phase {} plan time {} states {}", inbox_.plan_epoch(),
                       inbox_.plan_version(), scene_, to_string(inbox_.mission().phase()),
                       plan_time ? plan_time->plan_time_s : -1.0, states_);
  }
  const RefusalCounters& refused() const override { return inbox_.refused(); }

 private:
  static constexpr SteadyTime kSteady{std::chrono::seconds(500)};

  void receive(UtcTime now) override {
    inbox_.receive(kSteady, now, [this](RobotId id) -> const EchoGuard* {
      return id.value() == kOwnRobot ? &own_ : nullptr;
    });
    if (const auto scene = inbox_.take_scene()) scene_ = scene->version;
    inbox_.received().visit_near({10, 10}, [this](const agent::ReceivedState&) { ++states_; });
  }

  QueueChannel channel_;
  agent::Inbox inbox_;
  EchoGuard own_;
  std::uint64_t scene_ = 0;
  int states_ = 0;
};

// Its heartbeats are left out: it watches those of all planners, in any order
// (Gate::any_heartbeat).
class PlannerReceiver final : public QueueReceiver<CommandMessage, SceneMessage, StatusMessage> {
 public:
  explicit PlannerReceiver(const Mission& mission)
      : inbox_({reader<CommandMessage>(), reader<SceneMessage>(), reader<StatusMessage>(),
                std::make_unique<QueueReader<HeartbeatMessage>>(
                    std::make_shared<std::vector<HeartbeatMessage>>())},
               wire_limits(mission)) {}

  std::string state() override {
    return fmt::format("phase {} t0 {} scene {} statuses {}", to_string(inbox_.phase()),
                       inbox_.t0_utc_ns(), scene_, statuses_);
  }
  const RefusalCounters& refused() const override { return inbox_.refused(); }

 private:
  void receive(UtcTime now) override {
    inbox_.receive(now);
    for (const Scene& scene : inbox_.scenes()) scene_ = scene.version;
    statuses_ += inbox_.statuses().size();
  }

  planner::PlannerInbox inbox_;
  std::uint64_t scene_ = 0;
  std::size_t statuses_ = 0;
};

class LauncherReceiver final : public QueueReceiver<StatusMessage, EventMessage, HeartbeatMessage> {
 public:
  explicit LauncherReceiver(const Mission& mission)
      : inbox_({reader<StatusMessage>(), reader<EventMessage>(), reader<HeartbeatMessage>()},
               wire_limits(mission)) {}

  std::string state() override {
    return fmt::format("statuses {} events {} heartbeats {}", statuses_, events_, heartbeats_);
  }
  const RefusalCounters& refused() const override { return inbox_.refused(); }

 private:
  void receive(UtcTime now) override {
    inbox_.receive(now);
    statuses_ += inbox_.statuses().size();
    events_ += inbox_.events().size();
    heartbeats_ += inbox_.heartbeats().size();
  }

  launcher::HealthInbox inbox_;
  std::size_t heartbeats_ = 0;
  std::size_t statuses_ = 0;
  std::size_t events_ = 0;
};

class GatewayReceiver final : public QueueReceiver<CellStatesMessage> {
 public:
  explicit GatewayReceiver(const Mission& mission) : inbox_(wire_limits(mission)) {}

  std::string state() override { return fmt::format("passed on {}", passed_on_.size()); }
  const RefusalCounters& refused() const override { return inbox_.refused(); }

 private:
  void receive(UtcTime now) override {
    inbox_.take_fresh(*queue<CellStatesMessage>(), now, passed_on_);
    queue<CellStatesMessage>()->clear();
  }

  GatewayInbox inbox_;
  std::vector<RobotStateMessage> passed_on_;
};

/// Receives encoded samples, as from the bus.
class MonitorReceiver final : public Receiver {
 public:
  explicit MonitorReceiver(const Mission& mission) : sut_(mission, Stamps::kLive) {}

  bool reads(const AnyMessage&) const override { return true; }

  bool publish(const AnyMessage& message, UtcTime now) override {
    std::vector<std::byte> bytes;
    const bool encoded = std::visit([&](const auto& m) { return encode(m, bytes); }, message);
    if (!encoded) return false;
    const auto* begin = reinterpret_cast<const unsigned char*>(bytes.data());
    const std::vector<unsigned char> sample(begin, begin + bytes.size());
    sut_.take({.topic = topic_of(message), .received = now, .sent = now, .bytes = sample});
    return true;
  }

  std::string state() override {
    const UtcTime long_ago{};
    std::string text = fmt::format(
        "plan {} {} scene {} phase {} plan time {} mission time {} events {}", sut_.plan_version(),
        sut_.plan() ? sut_.plan()->digest() : 0, sut_.scene().version, to_string(sut_.phase()),
        sut_.plan_time_s(long_ago), sut_.mission_time_s(long_ago), sut_.events().size());
    for (const monitor::SwarmState::Robot& r : sut_.robots()) {
      text += fmt::format(" ({} {} {} {})", r.position_m.x(), r.position_m.y(), to_string(r.mode),
                          r.ticks);
    }
    return text;
  }
  const RefusalCounters& refused() const override { return sut_.refused(); }

 private:
  template <class M>
  static bool encode(const M& message, std::vector<std::byte>& bytes) {
    return link::encode(message, bytes);
  }
  /// Our encoder refuses a batch that is too long: the last state is appended to its bytes.
  static bool encode(CellStatesMessage batch, std::vector<std::byte>& bytes) {
    constexpr std::size_t kCountAt = 16, kStateBytes = 56;
    const auto count = static_cast<std::uint32_t>(batch.states.size());
    batch.states.resize(std::min(batch.states.size(), kMaxCellStates));
    if (!link::encode(batch, bytes)) return false;
    for (std::size_t i = batch.states.size(); i < count; ++i) {
      const std::vector<std::byte> last(bytes.end() - kStateBytes, bytes.end());
      bytes.insert(bytes.end(), last.begin(), last.end());
    }
    std::memcpy(bytes.data() + kCountAt, &count, sizeof count);
    return true;
  }
  static std::uint32_t topic_of(const AnyMessage& message) {
    static const std::vector<std::string> kNames = {
        "swarm/plan",   "swarm/scene", "swarm/heartbeat", "swarm/command",
        "swarm/status", "swarm/event", "swarm/cell"};
    const auto& topics = monitor::recorded_topics();
    const auto found = std::find_if(topics.begin(), topics.end(), [&](const auto& topic) {
      return topic.name == kNames[message.index()];
    });
    return static_cast<std::uint32_t>(found - topics.begin());
  }

  monitor::SwarmState sut_;
};

}  // namespace

std::unique_ptr<Receiver> make_agent(const Mission& mission) {
  return std::make_unique<AgentReceiver>(mission);
}
std::unique_ptr<Receiver> make_planner(const Mission& mission) {
  return std::make_unique<PlannerReceiver>(mission);
}
std::unique_ptr<Receiver> make_launcher(const Mission& mission) {
  return std::make_unique<LauncherReceiver>(mission);
}
std::unique_ptr<Receiver> make_monitor(const Mission& mission) {
  return std::make_unique<MonitorReceiver>(mission);
}
std::unique_ptr<Receiver> make_gateway_receiver(const Mission& mission) {
  return std::make_unique<GatewayReceiver>(mission);
}

}  // namespace swarm::link::conformance
