// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/conformance/bus.hpp"

#include <chrono>
#include <cstdlib>
#include <thread>
#include <utility>

#include <gtest/gtest.h>
#include <unistd.h>

#include "swarm_core/base/assert.hpp"
#include "swarm_link/adapters/cyclone/cyclone_participant.hpp"
#include "swarm_link/channels/groups/group_channel.hpp"
#include "swarm_link/roles/domain_lock.hpp"
#include "tests/support/inproc/inproc_bus.hpp"

namespace swarm::link::conformance {

namespace {

std::int64_t steady_ns() {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

class TestInprocBus final : public Bus {
 private:
  std::unique_ptr<Participant> make() override { return bus_.make_participant(); }

  InprocBus bus_;
};

class TestFastDdsBus final : public Bus {
 public:
  TestFastDdsBus(std::unique_ptr<DiscoveryServer> server, const DiscoveryAddress& discovery,
                 bool receive_at_tick, std::uint32_t first_index)
      : server_(std::move(server)),
        discovery_(discovery),
        receive_at_tick_(receive_at_tick),
        next_index_(first_index) {}

 private:
  std::unique_ptr<Participant> make() override {
    auto made = make_fastdds_participant({.name = "conformance",
                                          .domain = test_domain(),
                                          .index = next_index_++,
                                          .discovery = discovery_,
                                          .receive_at_tick = receive_at_tick_});
    SWARM_ASSERT(made.has_value());
    return *std::move(made);
  }

  std::unique_ptr<DiscoveryServer> server_;
  DiscoveryAddress discovery_;
  bool receive_at_tick_;
  std::uint32_t next_index_;
};

/// No server: each participant announces itself to those created before it.
class TestStaticPeersBus final : public Bus {
 private:
  std::unique_ptr<Participant> make() override {
    StaticPeers static_peers{.is_relay = true};
    for (std::uint32_t peer = 0; peer < next_index_; ++peer) static_peers.peers.push_back(peer);
    auto made = make_fastdds_participant({.name = "conformance",
                                          .domain = test_domain(),
                                          .index = next_index_++,
                                          .static_peers = static_peers});
    SWARM_ASSERT(made.has_value());
    return *std::move(made);
  }

  std::uint32_t next_index_ = 0;
};

class TestCycloneBus final : public Bus {
 private:
  std::unique_ptr<Participant> make() override {
    auto made = make_cyclone_participant({.name = "conformance", .domain = test_domain()});
    SWARM_ASSERT(made.has_value());
    return *std::move(made);
  }
};

/// Groups only, no topics.
class TestGroupBus final : public Bus {
 public:
  std::unique_ptr<StateChannel> channel(const CellOptions& options) override {
    auto made = make_group_channel({.domain = test_domain(), .cells = options});
    SWARM_ASSERT(made.has_value());
    return *std::move(made);
  }

 private:
  std::unique_ptr<Participant> make() override { return nullptr; }
};

}  // namespace

Bus::Hang::Hang() : deadline_ns_(steady_ns() + 30'000'000'000) {}
bool Bus::Hang::over() const { return steady_ns() > deadline_ns_; }

void Bus::rest() { std::this_thread::sleep_for(std::chrono::milliseconds(2)); }

Participant& Bus::participant() { return *participants_.emplace_back(make()); }

std::unique_ptr<StateChannel> Bus::channel(const CellOptions& options) {
  return make_topic_channel(participant(), options);
}

void Bus::pump() {
  for (const auto& participant : participants_) participant->receive();
}

void Bus::converge() {
  for (int i = 0; i < 50; ++i) {
    pump();
    rest();
  }
}

/// Reserved as a run does it: numbers by process ids alone meet those of flights, and of other
/// tests after some dozens of processes.
std::uint32_t test_domain() {
  static const DomainLock lock = [] {
    constexpr int kFirst = 10, kDomains = 80;
    constexpr DomainNeeds kNeeds{.participants = 100, .fixed = 20};
    for (int i = 0; i < kDomains; ++i) {
      auto taken = DomainLock::take(kFirst + (::getpid() + i) % kDomains, kNeeds);
      if (taken) return *std::move(taken);
    }
    SWARM_ASSERT(false && "no free domain");
    std::abort();
  }();
  return lock.domain();
}

std::unique_ptr<Bus> make_inproc_bus() { return std::make_unique<TestInprocBus>(); }

std::unique_ptr<Bus> make_fastdds_bus(bool receive_at_tick) {
  auto server = make_discovery_server(test_domain(), 0);
  SWARM_ASSERT(server.has_value());
  const auto discovery = (*server)->address();
  return std::make_unique<TestFastDdsBus>(*std::move(server), discovery, receive_at_tick, 0);
}

std::unique_ptr<Bus> join_fastdds_bus(const DiscoveryAddress& discovery,
                                      std::uint32_t first_index) {
  return std::make_unique<TestFastDdsBus>(nullptr, discovery, true, first_index);
}

const std::vector<Backend>& backends() {
  static const std::vector<Backend> all = {
      {"inproc", [] { return make_inproc_bus(); }},
      {"fastdds_at_tick", [] { return make_fastdds_bus(true); }},
      {"fastdds_threads", [] { return make_fastdds_bus(false); }},
      {"fastdds_peers",
       []() -> std::unique_ptr<Bus> { return std::make_unique<TestStaticPeersBus>(); }},
      {"cyclone", []() -> std::unique_ptr<Bus> { return std::make_unique<TestCycloneBus>(); }}};
  return all;
}

const std::vector<Backend>& channel_backends() {
  static const std::vector<Backend> all = [] {
    std::vector<Backend> list = backends();
    list.push_back(
        {"groups", []() -> std::unique_ptr<Bus> { return std::make_unique<TestGroupBus>(); }});
    return list;
  }();
  return all;
}

}  // namespace swarm::link::conformance
