// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A short run of the fuzz targets without a fuzzer: valid inputs and random changes of them. The
// long one is tests/fuzz/run.sh.
#include "tests/fuzz/decoders.hpp"

#include <algorithm>
#include <cstddef>
#include <string>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::fuzz {
namespace {

std::size_t below(Rng& rng, std::size_t end) { return rng() % end; }

/// One change: a flipped bit, other bytes, some left out or repeated, a number of extreme value.
void mutate(Bytes& bytes, Rng& rng) {
  if (bytes.empty()) bytes.push_back(static_cast<std::uint8_t>(rng()));
  const std::size_t at = below(rng, bytes.size());
  const std::size_t length = std::min(1 + below(rng, 16), bytes.size() - at);
  const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
  const auto end = begin + static_cast<std::ptrdiff_t>(length);
  switch (below(rng, 6)) {
    case 0:
      *begin ^= static_cast<std::uint8_t>(1U << below(rng, 8));
      break;
    case 1:
      *begin = static_cast<std::uint8_t>(rng());
      break;
    case 2:
      bytes.erase(begin, end);
      break;
    case 3: {
      const Bytes part(begin, end);
      bytes.insert(begin, part.begin(), part.end());
      break;
    }
    case 4:
      std::fill(begin, end, rng() % 2 == 0 ? std::uint8_t{0xFF} : std::uint8_t{0});
      break;
    default:
      bytes.resize(at);
      break;
  }
}

class Decoders : public testing::TestWithParam<Decoder> {};

TEST_P(Decoders, SurviveChangedInputs) {
  const Decoder& decoder = GetParam();
  Rng rng(7);
  const auto seeds = decoder.seeds();
  ASSERT_FALSE(seeds.empty());
  for (const Bytes& seed : seeds) {
    decoder.run(seed);
    for (int round = 0; round < 300; ++round) {
      Bytes bytes = seed;
      for (std::size_t changes = 1 + below(rng, 4); changes > 0; --changes) mutate(bytes, rng);
      decoder.run(bytes);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Decoders, testing::ValuesIn(decoders()),
                         [](const auto& decoder) { return std::string(decoder.param.name); });

}  // namespace
}  // namespace swarm::fuzz
