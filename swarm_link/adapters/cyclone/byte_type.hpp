// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>

struct ddsi_serdata;
struct ddsi_sertype;

/// A type of Cyclone DDS whose samples are their own bytes, as the vendor lets others define them
/// (ddsi_sertype, ddsi_serdata): it neither encodes nor decodes, and knows no IDL.
namespace swarm::link::cyclone {

/// Makes a type for dds_create_topic_sertype(), which takes ownership of it when it succeeds. Write
/// to such a topic with dds_write() and a Bytes, take from it with dds_takecdr() and bytes_of().
/// `keyed`: the first member, an unsigned long, is the key.
using Bytes = std::span<const std::byte>;
ddsi_sertype* make_byte_type(const std::string& name, bool keyed);

/// CDR of a sample, with its encapsulation. The view is valid as long as the sample.
Bytes bytes_of(const ddsi_serdata& sample);

}  // namespace swarm::link::cyclone
