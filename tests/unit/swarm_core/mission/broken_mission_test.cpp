// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// One mission file per mistake, in broken/. Its first line holds the expected message:
//   # expect LINE:COLUMN fragment of the message
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_launcher/processes/builtin_catalogue.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm {
namespace {

std::vector<std::filesystem::path> broken_files() {
  std::vector<std::filesystem::path> files;
  const std::filesystem::path folder =
      std::filesystem::path(SWARM_SOURCE_DIR) / "tests/unit/swarm_core/mission/broken";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry);
  std::sort(files.begin(), files.end());
  return files;
}

std::string test_name(const testing::TestParamInfo<std::filesystem::path>& info) {
  return info.param.stem().string();
}

class BrokenMission : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(BrokenMission, IsRefusedAtTheMistake) {
  std::ifstream file(GetParam());
  std::string hash, expect, place, fragment;
  file >> hash >> expect >> place >> std::ws;
  std::getline(file, fragment);
  ASSERT_EQ(expect, "expect");
  ASSERT_FALSE(fragment.empty());

  const auto mission = load_mission(GetParam(), builtin_catalogue());

  ASSERT_FALSE(mission.has_value());
  EXPECT_EQ(mission.error().code, ErrorCode::kBadInput);
  const std::string& message = mission.error().message;
  // Exactly one mistake in each file: neither missed nor followed by others that it causes.
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 0) << message;
  EXPECT_TRUE(message.starts_with(GetParam().filename().string() + ":" + place + ": ")) << message;
  EXPECT_NE(message.find(fragment), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(Files, BrokenMission, testing::ValuesIn(broken_files()), test_name);

TEST(BrokenMissions, AreManyKindsOfMistakes) { EXPECT_GE(broken_files().size(), 40U); }

}  // namespace
}  // namespace swarm
