// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/fastdds/cell_states_cdr.hpp"

#include <exception>

#include "swarm_link/fastdds/guarded_type.hpp"

namespace swarm::link {

namespace {

using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;

/// Lends bytes of ours to the vendor's payload, which would free them.
class Lent {
 public:
  explicit Lent(std::span<std::byte> bytes) {
    payload.data = reinterpret_cast<eprosima::fastrtps::rtps::octet*>(bytes.data());
    payload.length = payload.max_size = static_cast<std::uint32_t>(bytes.size());
  }
  ~Lent() { payload.data = nullptr; }
  Lent(const Lent&) = delete;
  Lent& operator=(const Lent&) = delete;

  Payload payload;
};

}  // namespace

struct CellStatesCdr::Impl {
  fastdds::GuardedType<CellStatesMessage> type;
  fastdds::WireOf<CellStatesMessage>::Type wire;
};

CellStatesCdr::CellStatesCdr() : impl_(std::make_unique<Impl>()) {}
CellStatesCdr::~CellStatesCdr() = default;

bool CellStatesCdr::encode(const CellStatesMessage& message, std::vector<std::byte>& out) {
  try {
    if (!fastdds::to_wire(message, impl_->wire)) return false;
    out.resize(impl_->type.getSerializedSizeProvider(&impl_->wire)());
    Lent lent(out);
    if (!impl_->type.serialize(&impl_->wire, &lent.payload)) return false;
    out.resize(lent.payload.length);
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

bool CellStatesCdr::decode(std::span<std::byte> bytes, CellStatesMessage& out) {
  Lent lent(bytes);
  if (!impl_->type.deserialize(&lent.payload, &impl_->wire)) return false;
  fastdds::from_wire(impl_->wire, out);
  return true;
}

}  // namespace swarm::link
