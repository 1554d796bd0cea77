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
#include <utility>
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
  return file.starts_with("swarm_link/adapters/fastdds/") ||
         file.starts_with("swarm_link/adapters/cyclone/") ||
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
                                           "swarm_sim",   "experiments",   "tests"};

TEST(Includes, OfVendorsStayInTheirAdapters) {
  static const std::regex kVendor(
      R"re(^(fastdds/|fastrtps/|fastcdr/|dds/|ddsc/|foonathan/|swarmPubSubTypes\.h$|swarm\.h$|ddsc?\.h$|hostile(PubSubTypes)?\.h$))re");
  const int files = for_each_include(kSources, [](const auto& file, const auto& include) {
    EXPECT_TRUE(may_include_vendor(file) || !std::regex_search(include, kVendor))
        << file << " includes " << include;
  });
  EXPECT_GT(files, 20);
}

/// Builds precompile headers, so a header that lacks a standard include compiles there: this test
/// keeps it complete.
TEST(Includes, OfTheStandardLibraryAreDirect) {
  const std::vector<std::pair<std::string, std::regex>> names = [] {
    std::vector<std::pair<std::string, std::regex>> list;
    for (const auto& [header, used] : std::map<std::string, std::string>{
             {"array", "array"},
             {"atomic", "atomic"},
             {"chrono", "chrono"},
             {"cstdint", "u?int(8|16|32|64)_t"},
             {"deque", "deque"},
             {"filesystem", "filesystem"},
             {"functional", "function"},
             {"limits", "numeric_limits"},
             {"map", "(multi)?map"},
             {"memory", "unique_ptr|shared_ptr|weak_ptr|make_unique|make_shared"},
             {"mutex", "mutex|lock_guard|unique_lock"},
             {"optional", "optional|nullopt"},
             {"set", "(multi)?set"},
             {"span", "span"},
             {"string", "string"},
             {"string_view", "string_view"},
             {"thread", "j?thread"},
             {"variant", "variant|visit|monostate"},
             {"vector", "vector"}}) {
      list.emplace_back(header, "std::(" + used + ")\\b");
    }
    return list;
  }();
  int headers = 0;
  auto folders = kSources;
  folders.push_back("include");
  for (const auto& folder : folders) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      if (entry.path().extension() != ".hpp") continue;
      ++headers;
      const auto includes = includes_of(entry.path());
      std::ifstream in(entry.path());
      std::string code;
      for (std::string line; std::getline(in, line);)
        code += line.substr(0, line.find("//")) + "\n";
      for (const auto& [header, used] : names) {
        EXPECT_TRUE(std::find(includes.begin(), includes.end(), header) != includes.end() ||
                    !std::regex_search(code, used))
            << fs::relative(entry.path(), kRoot) << " uses <" << header
            << "> and does not include it";
      }
    }
  }
  EXPECT_GT(headers, 200);
}

/// Fails where a file of `folder` includes one of our private headers that begins with none of
/// `allowed`.
void expect_knows_only(const std::string& folder, const std::vector<std::string>& allowed) {
  const int files = for_each_include({folder}, [&](const auto& file, const auto& include) {
    const bool is_private = std::any_of(kSources.begin(), kSources.end(), [&](const auto& source) {
      return include.starts_with(source + "/");
    });
    const bool is_allowed = std::any_of(allowed.begin(), allowed.end(), [&](const auto& beginning) {
      return include.starts_with(beginning);
    });
    EXPECT_TRUE(!is_private || is_allowed) << file << " includes " << include;
  });
  EXPECT_GT(files, 0) << folder;
}

TEST(Includes, PointDownwardsOnly) {
  expect_knows_only("include", {});
  expect_knows_only("swarm_core", {"swarm_core/"});
  expect_knows_only("swarm_link", {"swarm_core/", "swarm_link/"});
  expect_knows_only("planner_service", {"swarm_core/", "swarm_link/", "planner_service/"});
  expect_knows_only("robot_agent", {"swarm_core/", "swarm_link/", "robot_agent/"});
  expect_knows_only("swarm_monitor", {"swarm_core/", "swarm_link/", "swarm_monitor/"});
}

// One rule a target: what its folder may include of ours.
TEST(Includes, OfTheCoreKnowTheirRingAndThoseBefore) {
  std::vector<std::string> rings;
  for (const std::string ring : {"base/", "gmm/", "metrics/", "plan/", "risk/", "world/"}) {
    rings.push_back("swarm_core/" + ring);
  }
  for (const std::string& ring : std::vector<std::string>(rings)) {
    expect_knows_only(ring.substr(0, ring.size() - 1), rings);
  }
  expect_knows_only("swarm_core/files", {"swarm_core/files/"});
  expect_knows_only("swarm_core/robot_log",
                    {"swarm_core/robot_log/", "swarm_core/base/", "swarm_core/files/",
                     "swarm_core/metrics/", "swarm_core/plan/"});
  rings.push_back("swarm_core/mission/");
  expect_knows_only("swarm_core/mission", rings);
  rings.push_back("swarm_core/mission_file/");
  expect_knows_only("swarm_core/mission_file", rings);
}

TEST(Includes, OfTheLauncherLeadFromProgramsToSupervision) {
  const std::string core = "swarm_core/", launcher = "swarm_launcher/";
  expect_knows_only("swarm_launcher/supervision",
                    {core, launcher + "supervision/", "swarm_link/messages.hpp",
                     "swarm_link/event_names.hpp", "swarm_monitor/"});
  expect_knows_only("swarm_launcher/processes",
                    {core, launcher + "processes/", launcher + "supervision/"});
  expect_knows_only("swarm_launcher/hosts", {core, launcher + "hosts/", launcher + "processes/",
                                             launcher + "supervision/"});
  expect_knows_only("swarm_launcher/flight",
                    {core, launcher + "flight/", launcher + "hosts/", launcher + "processes/",
                     launcher + "supervision/", "swarm_link/"});
  expect_knows_only("swarm_launcher/cli", {core, launcher});
}

TEST(Includes, OfTheSimulatorKnowNoBusAndNoProcess) {
  expect_knows_only("swarm_sim",
                    {"swarm_core/", "swarm_sim/", "planner_service/", "robot_agent/",
                     "swarm_monitor/", "swarm_launcher/supervision/",
                     "swarm_launcher/processes/builtin_catalogue.hpp", "swarm_link/gate/"});
}

TEST(Includes, OfExperimentsAreUsedByNoOtherFolder) {
  for (const std::string& folder : kSources) {
    if (folder == "experiments" || folder == "tests") continue;
    for_each_include({folder}, [](const auto& file, const auto& include) {
      EXPECT_FALSE(include.starts_with("experiments/")) << file << " includes " << include;
    });
  }
}

// Such as the bus in memory, which no program has.
TEST(Includes, OfTestsAreUsedByNoOtherFolder) {
  for (const std::string& folder : kSources) {
    if (folder == "tests") continue;
    for_each_include({folder}, [](const auto& file, const auto& include) {
      EXPECT_FALSE(include.starts_with("tests/")) << file << " includes " << include;
    });
  }
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
    if (file.starts_with("planner_service/methods/") || file == "planner_service/program/main.cpp")
      return;
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
    const int files = for_each_include({"include/swarmflow/" + ring}, [&](const auto& file,
                                                                          const auto& include) {
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
