// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// The functions that read what others wrote, each as a fuzzer calls it.
namespace swarm::fuzz {

using Bytes = std::vector<std::uint8_t>;

/// One decoder. It must neither crash nor run for long, whatever the bytes are; where it accepts
/// them, what it made of them must hold its promises, else it aborts.
struct Decoder {
  std::string_view name;
  void (*run)(std::span<const std::uint8_t> bytes);
  std::vector<Bytes> (*seeds)();  ///< valid inputs, from which a fuzzer makes others
};

const std::vector<Decoder>& decoders();

/// Null if there is none of this name.
const Decoder* decoder_named(std::string_view name);

}  // namespace swarm::fuzz
