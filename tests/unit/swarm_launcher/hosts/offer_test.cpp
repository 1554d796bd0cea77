// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/hosts/offer.hpp"

#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "swarmflow/core/random.hpp"

namespace swarm::launcher {
namespace {

using nlohmann::json;

HostOffer offer() {
  return {.run = {.domain = 7,
                  .relays = 2,
                  .launcher = link::Vendor::kCycloneDds,
                  .planner = link::Vendor::kFastDds,
                  .host = "10.0.0.1",
                  .channel = Channel::kGroups,
                  .seed = std::numeric_limits<std::uint64_t>::max(),
                  .began = UtcTime(Duration(1'700'000'000'123'456'789))},
          .first_robot = 50,
          .robots = 25,
          .per_process = 5,
          .first_process = 10,
          .fault = "loss=0.2,delay-ms=150",
          .mission_yaml = "mission: \"x\"\n# Ω\trest\n"};
}

/// The offer as another program might send it: with one field changed.
std::string with(const char* key, const json& value) {
  json changed = json::parse(to_line(offer()));
  changed[key] = value;
  return changed.dump();
}

TEST(HostOffer, KeepsEveryField) {
  const std::string line = to_line(offer());
  EXPECT_EQ(line.find('\n'), std::string::npos) << "one line, whatever the mission contains";

  const auto back = parse_offer(line);

  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->run.launcher, link::Vendor::kCycloneDds);
  EXPECT_EQ(back->run.planner, link::Vendor::kFastDds);
  EXPECT_EQ(back->run.channel, Channel::kGroups);
  EXPECT_EQ(back->run.seed, std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(back->run.began, offer().run.began);
  EXPECT_EQ(back->per_process, 5U);
  EXPECT_EQ(back->first_process, 10U);
  EXPECT_EQ(back->fault, offer().fault);
  EXPECT_EQ(back->mission_yaml, offer().mission_yaml);
  EXPECT_EQ(to_line(*back), line);
}

TEST(HostOffer, IsRefusedWithoutAnyOneOfItsFields) {
  const json whole = json::parse(to_line(offer()));
  ASSERT_EQ(whole.size(), 15U);
  for (const auto& [key, value] : whole.items()) {
    json part = whole;
    part.erase(key);
    const auto refused = parse_offer(part.dump());
    ASSERT_FALSE(refused) << key;
    EXPECT_EQ(refused.error().code, ErrorCode::kBadInput);
    EXPECT_NE(refused.error().message.find("'" + key + "'"), std::string::npos)
        << refused.error().message;
  }
}

TEST(HostOffer, IsRefusedWithAFieldOfAnotherType) {
  const json whole = json::parse(to_line(offer()));
  const std::vector<json> others = {nullptr, true, 1, 2.5, "1", json::array(), json::object()};
  for (const auto& [key, value] : whole.items()) {
    for (const json& other : others) {
      if (other.type() == value.type()) continue;
      if (other.is_number_integer() && value.is_number_integer()) continue;
      EXPECT_FALSE(parse_offer(with(key.c_str(), other))) << key << ": " << other;
    }
  }
}

TEST(HostOffer, IsRefusedWithANumberThatDoesNotFit) {
  for (const char* key :
       {"domain", "hubs", "first_robot", "robots", "per_process", "first_process", "version"}) {
    for (const json& number :
         {json(-1), json(1.5), json(1e300), json((1ULL << 32U) + 2), json(-(1LL << 32U) + 2)}) {
      EXPECT_FALSE(parse_offer(with(key, number))) << key << ": " << number;
    }
  }
  EXPECT_FALSE(parse_offer(with("seed", -1)));
  EXPECT_FALSE(parse_offer(with("began_utc_ns", std::numeric_limits<std::uint64_t>::max())));
}

TEST(HostOffer, IsTakenUpToTheLimitsAndNoFurther) {
  const struct {
    const char* key;
    std::vector<std::uint32_t> good, bad;
  } cases[] = {{"domain", {0, 229}, {230}},
               {"hubs", {1, 1000}, {0, 1001}},
               {"robots", {1, 20'000 - 50}, {0, 20'000 - 49, 20'000}},
               {"first_robot", {0, 20'000 - 25}, {20'000 - 24, 20'000, 4'294'967'295U}},
               {"per_process", {1, 20'000}, {0, 20'001, 4'294'967'295U}},
               {"first_process", {0, 20'000}, {20'001}}};
  for (const auto& c : cases) {
    for (const std::uint32_t n : c.good) EXPECT_TRUE(parse_offer(with(c.key, n))) << c.key << n;
    for (const std::uint32_t n : c.bad) EXPECT_FALSE(parse_offer(with(c.key, n))) << c.key << n;
  }
}

TEST(HostOffer, ReportsARefusalAndAnotherRelease) {
  const auto refused = parse_offer(R"({"refused": "the mission has begun"})");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kEnvironment);
  EXPECT_EQ(refused.error().message, "the launcher refused: the mission has begun");

  const auto other = parse_offer(R"({"version": 7, "new": "form"})");
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::kEnvironment);
  EXPECT_EQ(other.error().message,
            "the launcher speaks version 7 of this protocol, this program 6: use the same release "
            "on all hosts");
}

// Whatever arrives, the answer is an offer within the limits or an error.
TEST(HostOffer, DamagedOnTheRouteIsAnErrorOrWithinTheLimits) {
  Rng rng(3);
  const std::string line = to_line(offer());
  for (int i = 0; i < 4000; ++i) {
    std::string damaged = line;
    for (std::size_t hits = 1 + rng() % 3; hits > 0; --hits) {
      char& c = damaged[rng() % damaged.size()];
      c = rng() % 2 == 0 ? static_cast<char>('0' + rng() % 10) : static_cast<char>(rng() % 256);
    }
    if (rng() % 4 == 0) damaged.resize(rng() % damaged.size());
    const auto got = parse_offer(damaged);
    if (!got) continue;
    EXPECT_LT(got->run.domain, 230U);
    EXPECT_GE(got->robots, 1U);
    EXPECT_GE(got->per_process, 1U);
    EXPECT_LE(got->first_robot + got->robots, 20'000U);
  }
}

// It becomes an argument of a process, and a difference to the clock.
TEST(HostOffer, HasNoControlCharactersAndNoTimeOutOfRange) {
  EXPECT_TRUE(parse_offer(with("fault", "loss=0.2")));
  EXPECT_FALSE(parse_offer(with("fault", "loss=0.2\x1b[2J")));
  EXPECT_FALSE(parse_offer(with("began_utc_ns", std::numeric_limits<std::int64_t>::min())));
}

// The host becomes a part of the DDS configuration, an XML text.
TEST(HostOffer, TakesNothingButAnAddressForTheHost) {
  EXPECT_TRUE(parse_offer(with("host", "192.168.7.4")));
  for (const char* host : {"", "launcher.local", "10.0.0.1:9", "10.0.0.256",
                           "--><Peer address='127.0.0.1:9\"/></Peers></Discovery><Tracing>"}) {
    EXPECT_FALSE(parse_offer(with("host", host))) << host;
  }
}

}  // namespace
}  // namespace swarm::launcher
