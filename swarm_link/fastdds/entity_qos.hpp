// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include "swarm_link/topics.hpp"

namespace swarm::link::fastdds {

/// Our QoS in the vendor's words: the one place where they are translated.
eprosima::fastdds::dds::DataWriterQos writer_qos(const Qos& qos, std::uint32_t ownership_strength);
eprosima::fastdds::dds::DataReaderQos reader_qos(const Qos& qos);

}  // namespace swarm::link::fastdds
