// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/run_directory.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace swarm::shell {
namespace {

constexpr std::size_t kMaxRunInfoBytes = 64U << 20U;  // with the mission, see run_inputs.hpp

/// The keys of `run.json`. What is wrong with one is thrown, as the parser does.
class RunKeys {
 public:
  explicit RunKeys(const nlohmann::json& json) : json_(json) {}

  std::string text(const char* key) const { return json_.at(key).get<std::string>(); }
  bool flag(const char* key) const { return json_.at(key).get<bool>(); }
  link::Vendor vendor(const char* is_cyclone) const {
    return flag(is_cyclone) ? link::Vendor::kCycloneDds : link::Vendor::kFastDds;
  }
  /// A whole number that fits its type: the parser alone would cut it off.
  template <class Number>
  Number number(const char* key) const {
    const nlohmann::json& value = json_.at(key);
    using Limits = std::numeric_limits<Number>;
    bool fits = false;
    if (value.is_number_unsigned()) {
      fits = std::in_range<Number>(value.get<std::uint64_t>());
    } else if (value.is_number_integer()) {
      fits = std::in_range<Number>(value.get<std::int64_t>());
    }
    if (fits) return value.get<Number>();
    throw std::invalid_argument(fmt::format("{} is {}, not a whole number from {} to {}", key,
                                            value.dump(), Limits::min(), Limits::max()));
  }
  Channel channel(const char* key) const {
    const std::string name = text(key);
    for (const Channel channel : {Channel::kTopics, Channel::kGroups}) {
      if (name == to_string(channel)) return channel;
    }
    throw std::invalid_argument(fmt::format("{} is \"{}\", not {} or {}", key, name,
                                            to_string(Channel::kTopics),
                                            to_string(Channel::kGroups)));
  }

 private:
  const nlohmann::json& json_;
};

}  // namespace

// rename() within one directory is atomic, so a reader finds the old content or the new one. The
// process id keeps two writers from sharing a temporary file.
Result<void> write_file(const std::filesystem::path& file, std::string_view content) {
  const std::filesystem::path temporary = file.string() + fmt::format(".tmp{}", ::getpid());
  {
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.flush();
    if (!out) {
      return fail(ErrorCode::kEnvironment, fmt::format("cannot write {}: {}; is the disk full?",
                                                       temporary.string(), std::strerror(errno)));
    }
  }
  std::error_code error;
  std::filesystem::rename(temporary, file, error);
  if (error) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("cannot write {}: {}", file.string(), error.message()));
  }
  return {};
}

// The size is checked before memory is allocated: a run directory may come from another machine.
Result<std::string> read_file(const std::filesystem::path& file, std::size_t max_bytes) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  if (error) {
    return fail(ErrorCode::kBadInput,
                fmt::format("cannot read {}: {}", file.string(), error.message()));
  }
  if (size > max_bytes) {
    return fail(ErrorCode::kBadInput,
                fmt::format("{} is larger than {} bytes", file.string(), max_bytes));
  }
  std::ifstream in(file, std::ios::binary);
  std::string content(size, '\0');
  in.read(content.data(), static_cast<std::streamsize>(size));
  if (!in) return fail(ErrorCode::kBadInput, fmt::format("cannot read {}", file.string()));
  return content;
}

// The key "hubs" is the file format's name of the relays.
std::string to_json(const RunInfo& info) {
  const nlohmann::json json = {{"domain", info.domain},
                               {"discovery_host", info.discovery_host},
                               {"discovery_port", info.discovery_port},
                               {"agents", info.agents},
                               {"hubs", info.relays},
                               {"cyclone_launcher", info.launcher == link::Vendor::kCycloneDds},
                               {"cyclone_planner", info.planner == link::Vendor::kCycloneDds},
                               {"host", info.host},
                               {"interface", info.interface},
                               {"channel", to_string(info.channel)},
                               {"seed", info.seed},
                               {"began_utc_ns", info.began.time_since_epoch().count()},
                               {"boot_id", info.clock.boot_id},
                               {"utc_minus_steady_ns", info.clock.utc_minus_steady_ns},
                               {"replay", info.is_replay}};
  return json.dump(2) + "\n";
}

Result<void> write_run_info(const std::filesystem::path& run_dir, const RunInfo& info) {
  return write_file(run_dir / kRunFile, to_json(info));
}

Result<RunInfo> read_run_info(const std::filesystem::path& run_dir) {
  return read_run_info_file(run_dir / kRunFile);
}

// Every key is required: a file that lacks one was written by another version, and its run cannot
// be joined.
Result<RunInfo> read_run_info_file(const std::filesystem::path& file) {
  const auto text = read_file(file, kMaxRunInfoBytes);
  if (!text) return tl::unexpected(text.error());
  try {
    const auto json = nlohmann::json::parse(*text);
    const RunKeys keys(json);
    return RunInfo{
        .domain = keys.number<std::uint32_t>("domain"),
        .discovery_host = keys.text("discovery_host"),
        .discovery_port = keys.number<std::uint16_t>("discovery_port"),
        .agents = keys.number<std::uint32_t>("agents"),
        .relays = keys.number<std::uint32_t>("hubs"),
        .launcher = keys.vendor("cyclone_launcher"),
        .planner = keys.vendor("cyclone_planner"),
        .host = keys.text("host"),
        .interface = keys.text("interface"),
        .channel = keys.channel("channel"),
        .seed = keys.number<std::uint64_t>("seed"),
        .began = UtcTime(Duration(keys.number<std::int64_t>("began_utc_ns"))),
        .clock = {.boot_id = keys.text("boot_id"),
                  .utc_minus_steady_ns = keys.number<std::int64_t>("utc_minus_steady_ns")},
        .is_replay = keys.flag("replay")};
  } catch (const std::exception& e) {
    return fail(ErrorCode::kBadInput,
                fmt::format("{}: not a run directory: {}", file.string(), e.what()));
  }
}

}  // namespace swarm::shell
