// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/adapters/cyclone/byte_type.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include <dds/dds.h>
#include <dds/ddsi/ddsi_keyhash.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_radmin.h>
#include <dds/ddsrt/md5.h>

namespace swarm::link::cyclone {
namespace {

constexpr std::size_t kHeadBytes = 4;
constexpr std::size_t kKeyBytes = sizeof(std::uint32_t);

// The vendor passes pointers to its own structs; ours begin with them, so a cast converts.
struct ByteType {
  ddsi_sertype base;
  bool keyed;
};
struct ByteSample {
  ddsi_serdata base;
  std::vector<std::byte> bytes;  // padded to a multiple of four, as on the wire
  std::uint32_t size;            // without the padding
  bool keyed;
  std::uint32_t key;
};
static_assert(std::is_standard_layout_v<ByteType> && std::is_standard_layout_v<ByteSample>);

const ByteType& as_ours(const ddsi_sertype* type) {
  return *reinterpret_cast<const ByteType*>(type);
}
const ByteSample& as_ours(const ddsi_serdata* sample) {
  return *reinterpret_cast<const ByteSample*>(sample);
}

std::uint32_t from_big_endian(const void* bytes) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes, sizeof value);
  return __builtin_bswap32(value);
}

// A sample with zeroed bytes. RTPS pads payloads to a multiple of four, so the memory does, too.
std::unique_ptr<ByteSample> make_sample(const ddsi_sertype* type, ddsi_serdata_kind kind,
                                        std::size_t size) {
  auto sample = std::make_unique<ByteSample>();
  ddsi_serdata_init(&sample->base, type, kind);
  sample->bytes.resize((size + 3) / 4 * 4);
  sample->size = static_cast<std::uint32_t>(size);
  sample->keyed = as_ours(type).keyed;
  return sample;
}

// The vendor looks instances up by this hash, so it must depend on the type and the key only.
void set_hash(ByteSample& sample) {
  sample.base.hash = sample.base.type->serdata_basehash;
  if (sample.keyed) sample.base.hash ^= sample.key * 2'654'435'761U;
}

/// Reads the key in the byte order of the sample and passes ownership to the vendor. Null, and the
/// sample is dropped, when it is too short for a key.
ddsi_serdata* finish(std::unique_ptr<ByteSample> sample) {
  if (sample->keyed) {
    if (sample->size < kHeadBytes + kKeyBytes) return nullptr;
    const std::byte* at = sample->bytes.data() + kHeadBytes;
    const std::uint32_t big = from_big_endian(at);
    const bool little = (sample->bytes[1] & std::byte{1}) == std::byte{1};
    sample->key = little ? __builtin_bswap32(big) : big;
  }
  set_hash(*sample);
  return &sample.release()->base;
}

bool same_key(const ddsi_serdata* a, const ddsi_serdata* b) {
  return as_ours(a).keyed == as_ours(b).keyed && as_ours(a).key == as_ours(b).key;
}

std::uint32_t size_of(const ddsi_serdata* sample) { return as_ours(sample).size; }

// Assembles a received sample from its fragments, which are sorted and may overlap. Null if bytes
// are missing or a fragment exceeds the sample.
ddsi_serdata* from_network(const ddsi_sertype* type, ddsi_serdata_kind kind,
                           const nn_rdata* fragment, std::size_t size) {
  if (size < kHeadBytes || size > UINT32_MAX) return nullptr;
  auto sample = make_sample(type, kind, size);
  std::size_t filled = 0;
  for (; fragment != nullptr; fragment = fragment->nextfrag) {
    if (fragment->min > filled || fragment->maxp1 > size) return nullptr;
    if (fragment->maxp1 <= filled) continue;  // contains nothing new
    const auto* payload = NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    std::memcpy(sample->bytes.data() + filled, payload + (filled - fragment->min),
                fragment->maxp1 - filled);
    filled = fragment->maxp1;
  }
  return filled == size ? finish(std::move(sample)) : nullptr;
}

// The same for a sample in consecutive pieces of memory.
ddsi_serdata* from_parts(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t parts,
                         const ddsrt_iovec_t* part, std::size_t size) {
  if (size < kHeadBytes || size > UINT32_MAX) return nullptr;
  auto sample = make_sample(type, kind, size);
  std::size_t filled = 0;
  for (ddsrt_msg_iovlen_t i = 0; i < parts && filled < size; ++i) {
    const std::size_t bytes = std::min<std::size_t>(part[i].iov_len, size - filled);
    std::memcpy(sample->bytes.data() + filled, part[i].iov_base, bytes);
    filled += bytes;
  }
  return finish(std::move(sample));
}

/// A sample with the key only, which the vendor needs when it disposes of an instance.
std::unique_ptr<ByteSample> key_sample(const ddsi_sertype* type, std::uint32_t key) {
  const std::size_t size = kHeadBytes + (as_ours(type).keyed ? kKeyBytes : 0);
  auto sample = make_sample(type, SDK_KEY, size);
  sample->bytes[1] = std::byte{1};
  sample->key = key;
  if (sample->keyed) std::memcpy(sample->bytes.data() + kHeadBytes, &key, sizeof key);
  set_hash(*sample);
  return sample;
}

ddsi_serdata* from_keyhash(const ddsi_sertype* type, const ddsi_keyhash* hash) {
  const std::uint32_t key = as_ours(type).keyed ? from_big_endian(hash->value) : 0;
  return &key_sample(type, key).release()->base;
}

// Makes a sample of what dds_write() was called with: a pointer to Bytes.
ddsi_serdata* from_sample(const ddsi_sertype* type, ddsi_serdata_kind kind, const void* written) {
  const Bytes bytes = *static_cast<const Bytes*>(written);
  if (bytes.size() < kHeadBytes || bytes.size() > UINT32_MAX) return nullptr;
  auto sample = make_sample(type, kind, bytes.size());
  std::copy(bytes.begin(), bytes.end(), sample->bytes.begin());
  return finish(std::move(sample));
}

void to_network(const ddsi_serdata* sample, std::size_t offset, std::size_t size, void* out) {
  std::memcpy(out, as_ours(sample).bytes.data() + offset, size);
}

// Lets the vendor send the bytes without a copy; the reference keeps them until give_back().
ddsi_serdata* lend(const ddsi_serdata* sample, std::size_t offset, std::size_t size,
                   ddsrt_iovec_t* lent) {
  lent->iov_base = const_cast<std::byte*>(as_ours(sample).bytes.data() + offset);
  lent->iov_len = static_cast<ddsrt_iov_len_t>(size);
  return ddsi_serdata_ref(sample);
}
void give_back(ddsi_serdata* sample, const ddsrt_iovec_t*) { ddsi_serdata_unref(sample); }

// Samples are taken by dds_takecdr() only, which needs no conversion.
bool to_sample(const ddsi_serdata*, void*, void**, void*) { return false; }
bool untyped_to_sample(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) {
  return false;
}

// The vendor's map from keys to instances stores samples without a type.
ddsi_serdata* to_untyped(const ddsi_serdata* sample) {
  auto untyped = key_sample(sample->type, as_ours(sample).key);
  untyped->base.type = nullptr;
  return &untyped.release()->base;
}

void free_sample(ddsi_serdata* sample) { delete reinterpret_cast<ByteSample*>(sample); }

std::size_t print(const ddsi_sertype*, const ddsi_serdata* sample, char* out, std::size_t size) {
  return static_cast<std::size_t>(std::snprintf(out, size, "%u bytes", as_ours(sample).size));
}

// The key hash of RTPS: the big-endian key, zero-padded to 16 bytes, or its MD5 if forced.
void get_keyhash(const ddsi_serdata* sample, ddsi_keyhash* hash, bool force_md5) {
  std::memset(hash->value, 0, sizeof hash->value);
  if (!as_ours(sample).keyed) return;
  const std::uint32_t big = __builtin_bswap32(as_ours(sample).key);
  if (!force_md5) {
    std::memcpy(hash->value, &big, sizeof big);
    return;
  }
  ddsrt_md5_state_t md5;
  ddsrt_md5_init(&md5);
  ddsrt_md5_append(&md5, reinterpret_cast<const ddsrt_md5_byte_t*>(&big), sizeof big);
  ddsrt_md5_finish(&md5, reinterpret_cast<ddsrt_md5_byte_t*>(hash->value));
}

constexpr ddsi_serdata_ops kSampleOps = [] {
  ddsi_serdata_ops ops{};
  ops.eqkey = same_key;
  ops.get_size = size_of;
  ops.from_ser = from_network;
  ops.from_ser_iov = from_parts;
  ops.from_keyhash = from_keyhash;
  ops.from_sample = from_sample;
  ops.to_ser = to_network;
  ops.to_ser_ref = lend;
  ops.to_ser_unref = give_back;
  ops.to_sample = to_sample;
  ops.to_untyped = to_untyped;
  ops.untyped_to_sample = untyped_to_sample;
  ops.free = free_sample;
  ops.print = print;
  ops.get_keyhash = get_keyhash;
  return ops;
}();

void free_type(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete reinterpret_cast<ByteType*>(type);
}
// Samples have no memory of the application, so these three have nothing to do.
void zero_samples(const ddsi_sertype*, void*, std::size_t) {}
void realloc_samples(void**, const ddsi_sertype*, void*, std::size_t, std::size_t) {}
void free_samples(const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {}
bool same_type(const ddsi_sertype*, const ddsi_sertype*) { return true; }  // names are equal
std::uint32_t hash_of(const ddsi_sertype*) { return 0; }

const ddsi_sertype_ops kTypeOps = [] {
  ddsi_sertype_ops ops{};
  ops.version = ddsi_sertype_v0;
  ops.free = free_type;
  ops.zero_samples = zero_samples;
  ops.realloc_samples = realloc_samples;
  ops.free_samples = free_samples;
  ops.equal = same_type;
  ops.hash = hash_of;
  return ops;
}();

}  // namespace

// XCDR1 only: our encoder writes nothing else.
ddsi_sertype* make_byte_type(const std::string& name, bool keyed) {
  auto type = std::make_unique<ByteType>();
  ddsi_sertype_init_flags(&type->base, name.c_str(), &kTypeOps, &kSampleOps,
                          keyed ? 0U : DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY);
  type->base.allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  type->keyed = keyed;
  return &type.release()->base;
}

Bytes bytes_of(const ddsi_serdata& sample) {
  const ByteSample& ours = as_ours(&sample);
  return Bytes(ours.bytes).first(ours.size);
}

}  // namespace swarm::link::cyclone
