// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/conformance/hostile/hostile_writer.hpp"

#include <map>
#include <string>
#include <utility>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/topic/Topic.hpp>

#include "hostilePubSubTypes.h"
#include "swarm_core/base/assert.hpp"
#include "swarm_link/adapters/fastdds/entity_qos.hpp"
#include "swarm_link/adapters/fastdds/participant_qos.hpp"
#include "swarm_link/topics.hpp"

namespace swarm::link::conformance {

namespace dds = eprosima::fastdds::dds;

struct HostilePeer::Impl {
  // One participant per kind of malformed sample: a type name can be registered only once in each.
  struct Line {
    dds::DomainParticipant* participant = nullptr;
    dds::DataWriter* writer = nullptr;
  };

  template <class Support, class M>
  dds::DataWriter& writer(const Topic<M>& topic, const std::string& type_name) {
    auto& line = lines[typeid(Support).name()];
    if (line.writer == nullptr) {
      const FastDdsOptions options{.name = "hostile",
                                   .domain = domain,
                                   .index = 60 + static_cast<std::uint32_t>(lines.size()),
                                   .discovery = discovery};
      const auto ports = fastdds::first_ports(domain, options.index).value();
      auto sockets = std::make_shared<fastdds::ReceiveSockets>(ports.data, false,
                                                               options.receive_buffer_bytes);
      line.participant = dds::DomainParticipantFactory::get_instance()->create_participant(
          domain, fastdds::client_qos(options, ports, std::move(sockets)));
      dds::TypeSupport support(new Support());
      support->setName(type_name.c_str());
      line.participant->register_type(support);
      auto* vendor_topic =
          line.participant->create_topic(topic.name, type_name, dds::TOPIC_QOS_DEFAULT);
      auto* publisher = line.participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
      line.writer = publisher->create_datawriter(vendor_topic, fastdds::writer_qos(topic.qos));
      SWARM_ASSERT(line.writer != nullptr);
    }
    return *line.writer;
  }

  static bool send(dds::DataWriter& to, void* sample) {
    dds::PublicationMatchedStatus status;
    to.get_publication_matched_status(status);
    return status.current_count > 0 && to.write(sample);
  }

  ~Impl() {
    for (auto& [name, line] : lines) {
      line.participant->delete_contained_entities();
      dds::DomainParticipantFactory::get_instance()->delete_participant(line.participant);
    }
  }

  std::uint32_t domain;
  DiscoveryAddress discovery;
  std::map<std::string, Line> lines{};
};

HostilePeer::HostilePeer(std::uint32_t domain, const DiscoveryAddress& discovery)
    : impl_(new Impl{domain, discovery}) {}
HostilePeer::~HostilePeer() = default;

bool HostilePeer::send_batch(std::size_t states) {
  hostile::CellStates sample;
  sample.schema_version(kSchemaVersion);
  sample.states().resize(states);
  return Impl::send(
      impl_->writer<hostile::CellStatesPubSubType>(cell_topic({0, 0}), "swarm::wire::CellStates"),
      &sample);
}

bool HostilePeer::send_plan(std::size_t nodes, std::size_t legs) {
  hostile::FlowPlan sample;
  sample.schema_version(kSchemaVersion);
  sample.nodes().resize(nodes);
  sample.legs().resize(legs);
  return Impl::send(
      impl_->writer<hostile::FlowPlanPubSubType>(plan_topic(), "swarm::wire::FlowPlan"), &sample);
}

bool HostilePeer::send_event(std::size_t code, std::size_t text) {
  hostile::Event sample;
  sample.schema_version(kSchemaVersion);
  sample.code() = std::string(code, 'c');
  sample.text() = std::string(text, 't');
  return Impl::send(impl_->writer<hostile::EventPubSubType>(event_topic(), "swarm::wire::Event"),
                    &sample);
}

bool HostilePeer::send_lying_batch(std::uint32_t count) {
  hostile::LyingCellStates sample;
  sample.schema_version(kSchemaVersion);
  sample.count(count);
  return Impl::send(impl_->writer<hostile::LyingCellStatesPubSubType>(cell_topic({0, 0}),
                                                                      "swarm::wire::CellStates"),
                    &sample);
}

bool HostilePeer::send_lying_plan(std::uint32_t nodes, std::uint32_t legs, std::uint32_t entries) {
  hostile::LyingFlowPlan sample;
  sample.schema_version(kSchemaVersion);
  sample.nodes(nodes);
  sample.legs(legs);
  sample.entries(entries);
  return Impl::send(
      impl_->writer<hostile::LyingFlowPlanPubSubType>(plan_topic(), "swarm::wire::FlowPlan"),
      &sample);
}

bool HostilePeer::send_lying_scene(std::uint32_t removed, std::uint32_t obstacles,
                                   std::uint32_t vertices, std::uint32_t goal) {
  hostile::LyingScene sample;
  sample.schema_version(kSchemaVersion);
  sample.removed(removed);
  sample.obstacles(obstacles);
  sample.vertices(vertices);
  sample.goal(goal);
  return Impl::send(
      impl_->writer<hostile::LyingScenePubSubType>(scene_topic(), "swarm::wire::Scene"), &sample);
}

bool HostilePeer::send_lying_status(std::uint32_t robots, std::uint8_t arrived,
                                    std::uint32_t refused, std::uint32_t state_age) {
  hostile::LyingStatus sample;
  sample.schema_version(kSchemaVersion);
  sample.robots(robots);
  sample.robot().arrived(arrived);
  sample.refused(refused);
  sample.state_age(state_age);
  return Impl::send(
      impl_->writer<hostile::LyingStatusPubSubType>(status_topic(), "swarm::wire::Status"),
      &sample);
}

bool HostilePeer::send_lying_event(std::uint32_t code) {
  hostile::LyingEvent sample;
  sample.schema_version(kSchemaVersion);
  sample.code(code);
  return Impl::send(
      impl_->writer<hostile::LyingEventPubSubType>(event_topic(), "swarm::wire::Event"), &sample);
}

bool HostilePeer::send_stub_heartbeat() {
  hostile::Stub sample;
  struct HeartbeatStub : hostile::StubPubSubType {};
  return Impl::send(impl_->writer<HeartbeatStub>(heartbeat_topic(), "swarm::wire::Heartbeat"),
                    &sample);
}

bool HostilePeer::send_stub_command() {
  hostile::Stub sample;
  struct CommandStub : hostile::StubPubSubType {};
  return Impl::send(impl_->writer<CommandStub>(command_topic(), "swarm::wire::Command"), &sample);
}

}  // namespace swarm::link::conformance
