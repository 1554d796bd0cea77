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

/// Our QoS in the vendor's words: the one place where they are translated.
eprosima::fastdds::dds::DataWriterQos writer_qos(const Qos& qos, std::uint32_t ownership_strength);

/// The multicast group that a topic's readers listen to. Topics may share one: a reader hears only
/// the writers it is matched with.
eprosima::fastrtps::rtps::Locator_t group_of(std::uint32_t domain, const std::string& topic);

/// `group`: where the reader listens instead of at its participant's own address.
eprosima::fastdds::dds::DataReaderQos reader_qos(
    const Qos& qos, const std::optional<eprosima::fastrtps::rtps::Locator_t>& group = {});

}  // namespace swarm::link::fastdds
