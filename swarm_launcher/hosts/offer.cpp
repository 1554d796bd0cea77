// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/hosts/offer.hpp"

#include <cstdint>
#include <stdexcept>
#include <utility>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "swarm_core/base/printable.hpp"
#include "swarm_core/base/stamp.hpp"

namespace swarm::launcher {
namespace {

// Raise it with every change of the offer or of the lines between the hosts.
constexpr int kVersion = 6;
constexpr std::uint32_t kMaxRobots = 20'000;

/// A field that is a whole number and fits into T. The JSON library would convert a fraction, a
/// truth value, a negative number or one that is too large without a complaint.
template <class T>
T whole(const nlohmann::json& json, const char* key) {
  const nlohmann::json& field = json.at(key);
  if (field.is_number_unsigned()) {
    if (const auto value = field.get<std::uint64_t>(); std::in_range<T>(value)) {
      return static_cast<T>(value);
    }
  } else if (field.is_number_integer()) {
    if (const auto value = field.get<std::int64_t>(); std::in_range<T>(value)) {
      return static_cast<T>(value);
    }
  }
  throw std::out_of_range(fmt::format("'{}' is no whole number of its range", key));
}

}  // namespace

// The keys are the protocol between hosts; "hubs" is the number of relay participants.
std::string to_line(const HostOffer& offer) {
  return nlohmann::json{{"version", kVersion},
                        {"domain", offer.run.domain},
                        {"hubs", offer.run.relays},
                        {"host", offer.run.host},
                        {"cyclone_launcher", offer.run.launcher == link::Vendor::kCycloneDds},
                        {"cyclone_planner", offer.run.planner == link::Vendor::kCycloneDds},
                        {"seed", offer.run.seed},
                        {"began_utc_ns", offer.run.began.time_since_epoch().count()},
                        {"first_robot", offer.first_robot},
                        {"robots", offer.robots},
                        {"per_process", offer.per_process},
                        {"first_process", offer.first_process},
                        {"fault", offer.fault},
                        {"mission", offer.mission_yaml},
                        {"sent_at_utc_ns", offer.sent_at.time_since_epoch().count()}}
      .dump();
}

// Any missing field or wrong type throws, here or in the JSON library, and becomes an error. Ranges
// are checked last: the values become ports, sizes and loop bounds.
Result<HostOffer> parse_offer(const std::string& line) {
  try {
    const auto json = nlohmann::json::parse(line);
    if (json.contains("refused")) {
      return fail(ErrorCode::kEnvironment,
                  "the launcher refused: " + json.at("refused").get<std::string>());
    }
    if (const int version = whole<int>(json, "version"); version != kVersion) {
      return fail(ErrorCode::kEnvironment,
                  fmt::format("the launcher speaks version {} of this protocol, this program {}: "
                              "use the same release on all hosts",
                              version, kVersion));
    }
    const auto vendor = [&json](const char* is_cyclone) {
      return json.at(is_cyclone).get<bool>() ? link::Vendor::kCycloneDds : link::Vendor::kFastDds;
    };
    HostOffer offer{.run = {.domain = whole<std::uint32_t>(json, "domain"),
                            .relays = whole<std::uint32_t>(json, "hubs"),
                            .launcher = vendor("cyclone_launcher"),
                            .planner = vendor("cyclone_planner"),
                            .host = json.at("host").get<std::string>(),
                            .channel = Channel::kGroups,
                            .seed = whole<std::uint64_t>(json, "seed"),
                            .began = UtcTime(Duration(whole<std::int64_t>(json, "began_utc_ns")))},
                    .first_robot = whole<std::uint32_t>(json, "first_robot"),
                    .robots = whole<std::uint32_t>(json, "robots"),
                    .per_process = whole<std::uint32_t>(json, "per_process"),
                    .first_process = whole<std::uint32_t>(json, "first_process"),
                    .fault = json.at("fault").get<std::string>(),
                    .mission_yaml = json.at("mission").get<std::string>(),
                    .sent_at = UtcTime(Duration(whole<std::int64_t>(json, "sent_at_utc_ns")))};
    // It becomes a part of the DDS configuration: nothing but an address may be in it.
    in_addr address{};
    const bool plausible =
        ::inet_pton(AF_INET, offer.run.host.c_str(), &address) == 1 && offer.run.domain < 230 &&
        offer.run.relays >= 1 && offer.run.relays <= 1000 &&
        is_stamp(offer.run.began.time_since_epoch().count()) &&
        is_stamp(offer.sent_at.time_since_epoch().count()) && is_printable(offer.fault) &&
        offer.robots >= 1 && offer.robots <= kMaxRobots && offer.first_robot <= kMaxRobots &&
        offer.first_robot + offer.robots <= kMaxRobots && offer.per_process >= 1 &&
        offer.per_process <= kMaxRobots && offer.first_process <= kMaxRobots;
    if (plausible) return offer;
    return fail(ErrorCode::kBadInput, "what answered is no launcher: its offer makes no sense");
  } catch (const std::exception& e) {
    return fail(
        ErrorCode::kBadInput,
        fmt::format("what answered is no launcher: its offer cannot be read: {}", e.what()));
  }
}

}  // namespace swarm::launcher
