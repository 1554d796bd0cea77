// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/cdr/codec.hpp"

#include <exception>

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include "swarm_link/cdr/conversion.hpp"
#include "swarm_link/cdr/lengths_fit.hpp"

namespace swarm::link {

using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

template <class M>
struct Codec<M>::Impl {
  typename cdr::WireOf<M>::Type wire;
};

template <class M>
Codec<M>::Codec() : impl_(std::make_unique<Impl>()) {}
template <class M>
Codec<M>::~Codec() = default;

template <class M>
bool Codec<M>::encode(const M& message, std::vector<std::byte>& out) {
  constexpr std::size_t kEncapsulation = 4;
  try {
    if (!cdr::to_wire(message, impl_->wire)) return false;
    // The encoder skips padding: what was there before must not go out.
    out.assign(kEncapsulation + cdr::WireOf<M>::Type::getCdrSerializedSize(impl_->wire),
               std::byte{0});
    FastBuffer buffer(reinterpret_cast<char*>(out.data()), out.size());
    Cdr stream(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    stream.serialize_encapsulation();
    impl_->wire.serialize(stream);
    out.resize(stream.getSerializedDataLength());
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

template <class M>
bool Codec<M>::decode(std::span<std::byte> bytes, M& out) {
  try {
    if (!cdr::is_plain(bytes) || !cdr::lengths_fit<typename cdr::WireOf<M>::Type>(bytes)) {
      return false;
    }
    FastBuffer buffer(reinterpret_cast<char*>(bytes.data()), bytes.size());
    Cdr stream(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    stream.read_encapsulation();
    impl_->wire.deserialize(stream);
  } catch (const std::exception&) {
    return false;
  }
  cdr::from_wire(impl_->wire, out);
  return true;
}

template class Codec<PlanMessage>;
template class Codec<SceneMessage>;
template class Codec<HeartbeatMessage>;
template class Codec<CellStatesMessage>;
template class Codec<CommandMessage>;
template class Codec<StatusMessage>;
template class Codec<EventMessage>;

}  // namespace swarm::link
