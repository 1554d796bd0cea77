// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/system/flown_run.hpp"

namespace swarm::test {

/// The small mission with more keys of its last section, `launcher`.
class EditedMission {
 public:
  explicit EditedMission(const std::string& launcher_keys) {
    std::ofstream(file()) << read_text(kSmallMission) << launcher_keys;
  }
  std::filesystem::path file() const { return folder_.path() / "mission.yaml"; }

 private:
  TemporaryFolder folder_;
};

}  // namespace swarm::test
