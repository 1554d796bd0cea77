// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include "swarm_link/topics.hpp"

namespace swarm::link::fastdds {

/// Translates our QoS to Fast DDS; no other file does.
eprosima::fastdds::dds::DataWriterQos writer_qos(const Qos& qos);

/// The multicast group of a topic, by a hash of its name. Topics may share a group: each reader
/// accepts only samples of the writers it is matched with.
eprosima::fastrtps::rtps::Locator_t group_of(std::uint32_t domain, const std::string& topic);

/// `group`: the reader receives from this group instead of its participant's own address.
eprosima::fastdds::dds::DataReaderQos reader_qos(
    const Qos& qos, const std::optional<eprosima::fastrtps::rtps::Locator_t>& group = {});

}  // namespace swarm::link::fastdds
