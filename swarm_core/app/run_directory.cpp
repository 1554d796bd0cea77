// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/run_directory.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace swarm::shell {
namespace {

constexpr std::size_t kMaxRunInfoBytes = 64U << 20U;  // with the mission, see run_inputs.hpp

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
                               {"utc_minus_steady_ns", info.clock.utc_minus_steady_ns}};
  return json.dump(2) + "\n";
}

Result<void> write_run_info(const std::filesystem::path& run_dir, const RunInfo& info) {
  return write_file(run_dir / kRunFile, to_json(info));
}

Result<RunInfo> read_run_info(const std::filesystem::path& run_dir) {
  return read_run_info_file(run_dir / kRunFile);
}

// Every key is required: a file that lacks one was written by another version, and its run cannot
// be joined. An unknown channel counts as topics.
Result<RunInfo> read_run_info_file(const std::filesystem::path& file) {
  const auto text = read_file(file, kMaxRunInfoBytes);
  if (!text) return tl::unexpected(text.error());
  try {
    const auto json = nlohmann::json::parse(*text);
    const auto vendor = [&json](const char* is_cyclone) {
      return json.at(is_cyclone).get<bool>() ? link::Vendor::kCycloneDds : link::Vendor::kFastDds;
    };
    return RunInfo{
        .domain = json.at("domain").get<std::uint32_t>(),
        .discovery_host = json.at("discovery_host").get<std::string>(),
        .discovery_port = json.at("discovery_port").get<std::uint16_t>(),
        .agents = json.at("agents").get<std::uint32_t>(),
        .relays = json.at("hubs").get<std::uint32_t>(),
        .launcher = vendor("cyclone_launcher"),
        .planner = vendor("cyclone_planner"),
        .host = json.at("host").get<std::string>(),
        .interface = json.at("interface").get<std::string>(),
        .channel = json.at("channel").get<std::string>() == to_string(Channel::kGroups)
                       ? Channel::kGroups
                       : Channel::kTopics,
        .seed = json.at("seed").get<std::uint64_t>(),
        .began = UtcTime(Duration(json.at("began_utc_ns").get<std::int64_t>())),
        .clock = {.boot_id = json.at("boot_id").get<std::string>(),
                  .utc_minus_steady_ns = json.at("utc_minus_steady_ns").get<std::int64_t>()}};
  } catch (const nlohmann::json::exception& e) {
    return fail(ErrorCode::kBadInput,
                fmt::format("{}: not a run directory: {}", file.string(), e.what()));
  }
}

}  // namespace swarm::shell
