// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/foreign_settings.hpp"

#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "swarm_core/base/foreign_settings.hpp"
#include "tests/unit/swarm_core/app/scratch_folder.hpp"

namespace swarm::shell {
namespace {

/// Begins without foreign settings, in a folder of its own, and restores both.
struct ForeignSettings : testing::Test {
  ForeignSettings() {
    for (const ForeignSetting& setting : kForeignSettings) {
      if (const char* value = std::getenv(setting.name)) before_[setting.name] = value;
      ::unsetenv(setting.name);
    }
    std::filesystem::current_path(folder_.path());
  }
  ~ForeignSettings() override {
    std::filesystem::current_path(from_);
    for (const ForeignSetting& setting : kForeignSettings) {
      const auto value = before_.find(setting.name);
      if (value == before_.end()) {
        ::unsetenv(setting.name);
      } else {
        ::setenv(setting.name, value->second.c_str(), 1);
      }
    }
    drop_foreign_settings();
  }

  std::map<std::string, std::string> before_;
  std::filesystem::path from_ = std::filesystem::current_path();
  ScratchFolder folder_;
};

TEST_F(ForeignSettings, AreNotMentionedWhereThereAreNone) {
  ::setenv("ROS_DISCOVERY_SERVER", "", 1);  // as good as none
  drop_foreign_settings();
  EXPECT_EQ(dropped_settings_notice(), std::nullopt);
}

TEST_F(ForeignSettings, ThatALibraryReadsAreRemovedAndNamed) {
  ::setenv("ROS_DISCOVERY_SERVER", "127.0.0.1:11811", 1);
  ::setenv("CYCLONEDDS_URI", "file:///nowhere.xml", 1);

  drop_foreign_settings();

  EXPECT_EQ(std::getenv("ROS_DISCOVERY_SERVER"), nullptr);
  EXPECT_EQ(std::getenv("CYCLONEDDS_URI"), nullptr);
  EXPECT_EQ(dropped_settings_notice(),
            "settings of other DDS and ROS programs have no effect on the bus of a run: "
            "ROS_DISCOVERY_SERVER, CYCLONEDDS_URI; the driver ros2 and `swarm_monitor ros` follow "
            "those of ROS");
}

TEST_F(ForeignSettings, OfRosStayForADriverThatUsesIt) {
  ::setenv("ROS_DOMAIN_ID", "7", 1);

  drop_foreign_settings();

  ASSERT_NE(std::getenv("ROS_DOMAIN_ID"), nullptr);
  EXPECT_STREQ(std::getenv("ROS_DOMAIN_ID"), "7");
  EXPECT_NE(dropped_settings_notice().value_or("").find("ROS_DOMAIN_ID"), std::string::npos);
}

TEST_F(ForeignSettings, IncludeAFileOfProfilesInTheCurrentDirectory) {
  folder_.write(kForeignProfiles, "<dds/>");
  drop_foreign_settings();
  EXPECT_NE(dropped_settings_notice().value_or("").find(kForeignProfiles), std::string::npos);
}

// A child inherits the cleaned environment.
TEST_F(ForeignSettings, AreNamedOnce) {
  ::setenv("FASTDDS_ENVIRONMENT_FILE", "/nowhere.json", 1);
  drop_foreign_settings();
  drop_foreign_settings();
  EXPECT_EQ(dropped_settings_notice(), std::nullopt);
}

}  // namespace
}  // namespace swarm::shell
