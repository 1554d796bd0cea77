// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace swarm {

/// A variable by which users configure other DDS and ROS programs.
struct ForeignSetting {
  const char* name;
  /// The DDS libraries read it behind our back, so it must go. The others are read by ROS alone,
  /// which a driver of a user's own may use: they stay.
  bool read_by_dds;
};

inline constexpr ForeignSetting kForeignSettings[] = {
    {"ROS_DISCOVERY_SERVER", true},
    {"ROS_SUPER_CLIENT", true},
    {"FASTDDS_ENVIRONMENT_FILE", true},
    {"FASTRTPS_DEFAULT_PROFILES_FILE", true},
    {"FASTDDS_DEFAULT_PROFILES_FILE", true},
    {"FASTDDS_STATISTICS", true},
    {"FASTDDS_BUILTIN_TRANSPORTS", true},
    {"CYCLONEDDS_URI", true},
    {"ROS_DOMAIN_ID", false},
    {"ROS_LOCALHOST_ONLY", false},
    {"RMW_IMPLEMENTATION", false},
    {"RMW_FASTRTPS_USE_QOS_FROM_XML", false},
    {"RMW_FASTRTPS_PUBLICATION_MODE", false},
};

/// Fast DDS reads a file of this name in the current directory, unless SKIP_DEFAULT_XML forbids it.
inline constexpr const char* kForeignProfiles = "DEFAULT_FASTRTPS_PROFILES.xml";

/// Names of the foreign settings that are there now. O(settings), reads the environment.
inline std::vector<std::string> foreign_settings() {
  std::vector<std::string> found;
  for (const ForeignSetting& setting : kForeignSettings) {
    const char* value = std::getenv(setting.name);
    if (value != nullptr && *value != '\0') found.emplace_back(setting.name);
  }
  std::error_code error;
  if (std::filesystem::exists(kForeignProfiles, error)) found.emplace_back(kForeignProfiles);
  return found;
}

/// Under this prefix ignore_foreign_settings() keeps what it hides from the DDS libraries: the
/// drivers of ROS robots follow it.
inline constexpr const char* kKeptPrefix = "SWARMFLOW_KEPT_";

/// A setting as the user made it, hidden or not; empty if there is none.
inline std::string foreign_setting(const std::string& name) {
  for (const std::string& key : {name, kKeptPrefix + name}) {
    if (const char* value = std::getenv(key.c_str()); value != nullptr) return value;
  }
  return {};
}

/// Makes the DDS libraries of this process, and of its children, ignore foreign settings: a run
/// has its own discovery, transports and domain. To be called before the first call of a DDS
/// library, and while no other thread reads the environment.
inline void ignore_foreign_settings() {
  for (const ForeignSetting& setting : kForeignSettings) {
    const char* const value = std::getenv(setting.name);
    if (!setting.read_by_dds || value == nullptr) continue;
    ::setenv((kKeptPrefix + std::string(setting.name)).c_str(), value, 1);
    ::unsetenv(setting.name);
  }
  // The name differs between versions of the library.
  for (const char* skip : {"SKIP_DEFAULT_XML", "SKIP_DEFAULT_XML_FILE"}) ::setenv(skip, "1", 1);
}

}  // namespace swarm
