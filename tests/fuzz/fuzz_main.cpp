// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// libFuzzer's entry: fuzzes the decoder that the environment variable SWARM_FUZZ names.
// tests/fuzz/run.sh calls it.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/decoders.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const swarm::fuzz::Decoder* const decoder = [] {
    const char* const name = std::getenv("SWARM_FUZZ");
    const auto* const found = name == nullptr ? nullptr : swarm::fuzz::decoder_named(name);
    if (found == nullptr) {
      std::fputs("SWARM_FUZZ names no decoder of tests/fuzz/decoders.cpp\n", stderr);
      std::exit(3);
    }
    return found;
  }();
  decoder->run({data, size});
  return 0;
}
