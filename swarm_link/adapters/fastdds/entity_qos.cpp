// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/adapters/fastdds/entity_qos.hpp"

#include <algorithm>

#include "swarm_link/adapters/fastdds/loopback_transport.hpp"

namespace swarm::link::fastdds {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

// The vendor's default is 10 instances: statuses of an eleventh group of robots would be dropped.
constexpr int kMaxInstances = 16'384;

// The part of the QoS that writers and readers have in common. Data-sharing is off, because every
// sample is to take the same path: the network.
template <class VendorQos>
void translate(const Qos& qos, int depth, VendorQos& out) {
  out.reliability().kind = qos.reliability == Reliability::kReliable
                               ? dds::RELIABLE_RELIABILITY_QOS
                               : dds::BEST_EFFORT_RELIABILITY_QOS;
  out.durability().kind = qos.durability == Durability::kTransientLocal
                              ? dds::TRANSIENT_LOCAL_DURABILITY_QOS
                              : dds::VOLATILE_DURABILITY_QOS;
  out.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  out.history().depth = depth;
  out.resource_limits().max_instances = kMaxInstances;
  out.resource_limits().max_samples_per_instance = depth;
  out.resource_limits().max_samples = kMaxInstances * depth;
  out.resource_limits().allocated_samples = 1;
  // Buffers grow to the size of actual samples instead of the largest possible one.
  out.endpoint().history_memory_policy = rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
  out.data_sharing().off();  // no shared memory
}

}  // namespace

// Large samples are sent asynchronously: a thread of the vendor sends their fragments. The
// heartbeat period bounds how long a reader does not notice that the last sample was lost.
dds::DataWriterQos writer_qos(const Qos& qos) {
  dds::DataWriterQos out;
  translate(qos, qos.depth, out);
  out.publish_mode().kind =
      qos.large ? dds::ASYNCHRONOUS_PUBLISH_MODE : dds::SYNCHRONOUS_PUBLISH_MODE;
  out.reliable_writer_qos().times.heartbeatPeriod = {1, 0};
  return out;
}

// Hashes the topic's name into a group of the domain; all participants compute the same one.
rtps::Locator_t group_of(std::uint32_t domain, const std::string& topic) {
  std::uint32_t hash = 2'166'136'261U;  // FNV-1a
  for (const char c : topic) hash = (hash ^ static_cast<unsigned char>(c)) * 16'777'619U;
  return to_locator(multicast_group(domain, hash));
}

dds::DataReaderQos reader_qos(const Qos& qos, const std::optional<rtps::Locator_t>& group) {
  dds::DataReaderQos out;
  translate(qos, std::max(qos.depth, qos.reader_depth), out);
  if (group) out.endpoint().multicast_locator_list.push_back(*group);
  return out;
}

}  // namespace swarm::link::fastdds
