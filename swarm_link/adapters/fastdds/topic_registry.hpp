// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/topic/Topic.hpp>

#include "swarmflow/core/result.hpp"

namespace swarm::link::fastdds {

/// The vendor's topics of one participant, counted by their endpoints. The last endpoint deletes
/// its topic, because cell topics come and go for hours. Not thread-safe.
class TopicRegistry {
 public:
  /// \pre the participant outlives the registry
  explicit TopicRegistry(eprosima::fastdds::dds::DomainParticipant& participant)
      : participant_(participant) {}

  /// Creates the topic, or adds a user to it. Fails when it exists with another type.
  Result<eprosima::fastdds::dds::Topic*> acquire(const std::string& name, const std::string& type);
  /// Removes a user. \pre acquired before
  void release(const std::string& name);

 private:
  struct Entry {
    eprosima::fastdds::dds::Topic* topic = nullptr;
    int uses = 0;  ///< endpoints of it
  };
  eprosima::fastdds::dds::DomainParticipant& participant_;
  std::map<std::string, Entry> entries_;  ///< by name
};

}  // namespace swarm::link::fastdds
