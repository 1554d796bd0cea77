// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Vendor headers are on the default include path, so the compiler cannot keep them in their
// folders: this test does.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace {

namespace fs = std::filesystem;

const fs::path kRoot = SWARM_SOURCE_DIR;

bool is_source(const fs::path& file) {
  const auto extension = file.extension();
  return extension == ".hpp" || extension == ".cpp" || extension == ".h" || extension == ".c";
}

bool may_include_vendor(const std::string& file) {
  if (file == "swarm_link/adapters/fastdds/fastdds_participant.hpp" ||
      file == "swarm_link/adapters/cyclone/cyclone_participant.hpp") {
    return false;  // their public faces
  }
  return file.starts_with("swarm_link/adapters/fastdds/") || file.starts_with("swarm_link/adapters/cyclone/") ||
         file.starts_with("tests/conformance/hostile/") ||
         file.starts_with("tests/conformance/idl/");
}

std::vector<std::string> includes_of(const fs::path& file) {
  static const std::regex kInclude(R"re(^\s*#\s*include\s*[<"]([^>"]+)[>"])re");
  std::vector<std::string> includes;
  std::ifstream in(file);
  std::smatch match;
  for (std::string line; std::getline(in, line);) {
    if (std::regex_search(line, match, kInclude)) includes.push_back(match[1]);
  }
  return includes;
}

template <class Check>
int for_each_include(const std::vector<std::string>& folders, Check check) {
  int files = 0;
  for (const auto& folder : folders) {
    if (!fs::exists(kRoot / folder)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      if (!entry.is_regular_file() || !is_source(entry.path())) continue;
      ++files;
      const auto name = fs::relative(entry.path(), kRoot).generic_string();
      for (const auto& include : includes_of(entry.path())) check(name, include);
    }
  }
  return files;
}

const std::vector<std::string> kSources = {"swarm_core",  "swarm_link",    "planner_service",
                                           "robot_agent", "swarm_monitor", "swarm_launcher",
                                           "tests"};

TEST(Includes, OfVendorsStayInTheirAdapters) {
  static const std::regex kVendor(
      R"re(^(fastdds/|fastrtps/|fastcdr/|dds/|ddsc/|foonathan/|swarmPubSubTypes\.h$|swarm\.h$|ddsc?\.h$|hostile(PubSubTypes)?\.h$))re");
  const int files = for_each_include(kSources, [](const auto& file, const auto& include) {
    EXPECT_TRUE(may_include_vendor(file) || !std::regex_search(include, kVendor))
        << file << " includes " << include;
  });
  EXPECT_GT(files, 20);
}

TEST(Includes, PointDownwardsOnly) {
  const auto knows_only = [](const std::string& folder, const std::vector<std::string>& allowed) {
    for_each_include({folder}, [&](const auto& file, const auto& include) {
      for (const auto& other : kSources) {
        if (!include.starts_with(other + "/")) continue;
        EXPECT_NE(std::find(allowed.begin(), allowed.end(), other), allowed.end())
            << file << " includes " << include;
      }
    });
  };
  knows_only("include", {});
  knows_only("swarm_core", {"swarm_core"});
  knows_only("swarm_link", {"swarm_core", "swarm_link"});
  knows_only("planner_service", {"swarm_core", "swarm_link", "planner_service"});
  knows_only("robot_agent", {"swarm_core", "swarm_link", "robot_agent"});
}

// So that it can be used, and tested, without a bus.
TEST(Includes, OfTheGateKnowMessagesAndTheCoreAlone) {
  const int files =
      for_each_include({"swarm_link/gate"}, [](const auto& file, const auto& include) {
        if (!include.starts_with("swarm_link/")) return;
        EXPECT_TRUE(include.starts_with("swarm_link/gate/") ||
                    include == "swarm_link/messages.hpp" || include == "swarm_link/wire_bounds.hpp")
            << file << " includes " << include;
      });
  EXPECT_GT(files, 5);
}

bool starts_with_any(const std::string& name, const std::vector<std::string>& beginnings) {
  return std::any_of(beginnings.begin(), beginnings.end(),
                     [&](const std::string& beginning) { return name.starts_with(beginning); });
}

TEST(Includes, OfThePlannerLeadFromMethodsToFlowToRoadmap) {
  const auto knows_only = [](const std::string& folder, const std::vector<std::string>& allowed) {
    const int files =
        for_each_include({"planner_service/" + folder}, [&](const auto& file, const auto& include) {
          const bool is_core =
              !starts_with_any(include, kSources) || include.starts_with("swarm_core/");
          EXPECT_TRUE(is_core || starts_with_any(include, allowed))
              << file << " includes " << include;
        });
    EXPECT_GT(files, 1) << folder;
  };
  const std::string root = "planner_service/";
  const std::string contract = "swarmflow/planning/";
  knows_only("roadmap", {root + "roadmap/", contract + "roadmap.hpp"});
  knows_only("flow", {root + "flow/", root + "roadmap/", contract + "roadmap.hpp",
                      contract + "density_peak.hpp"});
  knows_only("groups", {root + "groups/", root + "roadmap/", contract + "measured_swarm.hpp"});
  std::vector<std::string> below = {"swarmflow/planning/"};
  for (const char* name : {"flow/", "groups/", "roadmap/", "stage_timer.hpp", "methods/shared/"}) {
    below.push_back(root + name);
  }
  for (const std::string method : {"adoc", "crops", "rover", "shared", "swarmprm"}) {
    std::vector<std::string> allowed = below;
    allowed.push_back(root + "methods/" + method + "/");
    knows_only("methods/" + method, allowed);
  }
}

TEST(Includes, OfThePlannerDoNotNameAMethod) {
  for_each_include({"planner_service"}, [](const auto& file, const auto& include) {
    if (file.starts_with("planner_service/methods/") || file == "planner_service/program/main.cpp") return;
    EXPECT_FALSE(include.starts_with("planner_service/methods/"))
        << file << " includes " << include;
  });
}

// The public headers: they include nothing private, no type of a vendor or parser, and each layer
// knows only the layers within.
TEST(Includes, OfPublicHeadersArePublic) {
  static const std::regex kThirdParty(
      R"re(^(fmt|nlohmann|yaml-cpp|CLI|coin|lemon|nanoflann|png|zstd|zlib)\b)re");
  const std::map<std::string, std::vector<std::string>> allowed = {
      {"core", {"core"}},
      {"mission", {"core", "mission"}},
      {"robot", {"core", "mission", "robot"}},
      {"planning", {"core", "mission", "planning"}},
      {"observe", {"core", "mission", "observe"}}};
  for (const auto& [ring, known] : allowed) {
    const int files =
        for_each_include({"include/swarmflow/" + ring}, [&](const auto& file, const auto& include) {
          EXPECT_FALSE(starts_with_any(include, kSources) || std::regex_search(include, kThirdParty))
              << file << " includes " << include;
          if (!include.starts_with("swarmflow/")) return;
          const bool is_known = std::any_of(known.begin(), known.end(), [&](const auto& other) {
            return include.starts_with("swarmflow/" + other + "/");
          });
          EXPECT_TRUE(is_known) << file << " includes " << include;
        });
    EXPECT_GT(files, 0) << ring;
  }
}

TEST(Includes, MixNoVendorsInOneFolder) {
  for_each_include({"swarm_link/adapters/fastdds"}, [](const auto& file, const auto& include) {
    EXPECT_FALSE(include.starts_with("dds/") || include.starts_with("ddsc")) << file;
  });
  for_each_include({"swarm_link/adapters/cyclone"}, [](const auto& file, const auto& include) {
    EXPECT_FALSE(include.starts_with("fast")) << file << " includes " << include;
  });
}

}  // namespace
