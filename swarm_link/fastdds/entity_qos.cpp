// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/fastdds/entity_qos.hpp"

namespace swarm::link::fastdds {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

// The vendor's default of 10 instances would drop the eleventh robot's status.
constexpr int kMaxInstances = 16'384;

template <class VendorQos>
void translate(const Qos& qos, VendorQos& out) {
  out.reliability().kind = qos.reliability == Reliability::kReliable
                               ? dds::RELIABLE_RELIABILITY_QOS
                               : dds::BEST_EFFORT_RELIABILITY_QOS;
  out.durability().kind = qos.durability == Durability::kTransientLocal
                              ? dds::TRANSIENT_LOCAL_DURABILITY_QOS
                              : dds::VOLATILE_DURABILITY_QOS;
  out.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  out.history().depth = qos.depth;
  out.resource_limits().max_instances = kMaxInstances;
  out.resource_limits().max_samples_per_instance = qos.depth;
  out.resource_limits().max_samples = kMaxInstances * qos.depth;
  out.resource_limits().allocated_samples = 1;
  out.ownership().kind = qos.ownership == Ownership::kExclusive ? dds::EXCLUSIVE_OWNERSHIP_QOS
                                                                : dds::SHARED_OWNERSHIP_QOS;
  // Buffers as large as the samples that come, not as the largest that could.
  out.endpoint().history_memory_policy = rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
  out.data_sharing().off();  // no shared memory
}

}  // namespace

dds::DataWriterQos writer_qos(const Qos& qos, std::uint32_t ownership_strength) {
  dds::DataWriterQos out;
  translate(qos, out);
  out.ownership_strength().value = ownership_strength;
  out.publish_mode().kind =
      qos.large ? dds::ASYNCHRONOUS_PUBLISH_MODE : dds::SYNCHRONOUS_PUBLISH_MODE;
  out.reliable_writer_qos().times.heartbeatPeriod = {1, 0};
  return out;
}

dds::DataReaderQos reader_qos(const Qos& qos) {
  dds::DataReaderQos out;
  translate(qos, out);
  return out;
}

}  // namespace swarm::link::fastdds
