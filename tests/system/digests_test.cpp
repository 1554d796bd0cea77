// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Results of `simulate` for every mission of deploy/missions, to the last bit, against
// tests/data/digests.txt. A commit that changes a line there explains why. tests/digests.sh flies
// more seeds and rewrites the file.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "program.hpp"
#include "simulated_digest.hpp"

namespace swarm::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDigests = SWARM_SOURCE_DIR "/tests/data/digests.txt";
constexpr const char* kTooLong = "diffusion_q_corner";  // minutes; diffusion_q has its methods
constexpr const char* kBadNetwork = "loss=0.2,delay-ms=150,jitter-ms=50";

std::vector<std::string> missions() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(SWARM_SOURCE_DIR "/deploy/missions")) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() != ".yaml" || name == kTooLong) continue;
    // A simulation does not move real robots.
    if (read_text(entry.path()).find("model: ros2") == std::string::npos) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Line by line: `mission network seed` → digest.
std::map<std::string, std::string> stored_digests() {
  std::map<std::string, std::string> stored;
  std::ifstream in(kDigests);
  for (std::string line; std::getline(in, line);) {
    const auto digest = line.find(" steps=");
    if (line.starts_with('#') || digest == std::string::npos) continue;
    stored[line.substr(0, digest)] = line.substr(digest + 1);
  }
  return stored;
}

/// Set by tests/digests.sh; empty where the tests fly one seed of the quick missions.
std::optional<std::uint64_t> seeds_asked() {
  const char* const asked = std::getenv("SWARM_DIGEST_SEEDS");
  if (asked == nullptr) return std::nullopt;
  return std::strtoull(asked, nullptr, 10);
}

/// Missions with a new plan every second or very many robots: tens of seconds each.
bool is_slow(const std::string& mission) {
  return mission.starts_with("rover") || mission.starts_with("diffusion") || mission == "big";
}

/// The mathematical functions of the C library round differently on processors without fused
/// multiply-add.
bool rounds_as_stored() {
#ifdef __x86_64__
  return read_text("/proc/cpuinfo").find(" fma ") != std::string::npos;
#else
  return false;
#endif
}

class Digests : public ::testing::TestWithParam<std::string> {};

TEST_P(Digests, AreThoseStored) {
  if (!rounds_as_stored()) GTEST_SKIP() << "the digests are of an x86_64 processor with fma";
  if (!seeds_asked() && is_slow(GetParam())) GTEST_SKIP() << "flown by tests/digests.sh";
  const std::map<std::string, std::string> stored = stored_digests();
  for (std::uint64_t seed = 1; seed <= seeds_asked().value_or(1); ++seed) {
    for (const bool bad : {false, true}) {
      const std::string key = fmt::format("{} {} {}", GetParam(), bad ? "bad" : "good", seed);
      const auto digest = simulated_digest(
          {.mission_file = fs::path(SWARM_SOURCE_DIR "/deploy/missions") / (GetParam() + ".yaml"),
           .fault = bad ? kBadNetwork : "",
           .seed = seed});
      ASSERT_TRUE(digest.has_value()) << digest.error().message;
      std::cout << "digest: " << key << ' ' << *digest << '\n';  // what digests.sh collects
      const auto found = stored.find(key);
      EXPECT_EQ(*digest, found == stored.end() ? "" : found->second) << key;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Mission, Digests, ::testing::ValuesIn(missions()),
                         [](const auto& mission) { return mission.param; });

}  // namespace
}  // namespace swarm::test
