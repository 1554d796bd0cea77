// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/run_inputs.hpp"

#include <filesystem>
#include <optional>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "swarm_core/app/memory_file.hpp"
#include "swarmflow/mission/mission_file.hpp"
#include "tests/unit/swarm_core/app/scratch_folder.hpp"

namespace swarm::shell {
namespace {

Mission a_mission() { return load_mission(SWARM_SOURCE_DIR "/deploy/missions/small.yaml").value(); }
const RunInfo kRun{.domain = 7, .discovery_port = 1234, .agents = 3, .seed = 11};

TEST(RunInputs, AreTheSameFromMemoryAndFromTheRunDirectory) {
  const ScratchFolder folder;
  const Mission mission = a_mission();
  ASSERT_TRUE(write_run_info(folder.path(), kRun));
  folder.write(std::string(kMissionFile), to_yaml(mission));
  const auto memory = MemoryFile::make("inputs", to_json(kRun, to_yaml(mission)));
  ASSERT_TRUE(memory) << memory.error().message;

  for (const std::string& inputs : {std::string(), memory->path()}) {
    const auto read = read_run_inputs(folder.path(), inputs, open_catalogue());
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->run.domain, 7U);
    EXPECT_EQ(read->run.discovery_port, 1234);
    EXPECT_EQ(read->run.seed, 11U);
    EXPECT_EQ(to_yaml(read->mission), to_yaml(mission));
  }
}

TEST(RunInputs, NameWhatIsWrong) {
  const ScratchFolder folder;
  folder.write("no_mission", to_json(kRun));
  folder.write("bad_mission", to_json(kRun, "robots: 3\n"));
  for (const char* inputs : {"", "none", "no_mission", "bad_mission"}) {
    const auto file = *inputs == 0 ? std::filesystem::path() : folder / inputs;
    const auto read = read_run_inputs(folder.path(), file, open_catalogue());
    ASSERT_FALSE(read) << inputs;
    EXPECT_EQ(read.error().code, ErrorCode::kBadInput) << inputs;
  }
}

TEST(MemoryFile, CanBeReadByOtherProcessesAndNotChanged) {
  const auto sut = MemoryFile::make("test", "content");
  ASSERT_TRUE(sut);
  const std::string path = sut->path();  // of this process
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::execl("/bin/sh", "sh", "-c", "test `cat $0` = content && ! (echo x >$0) 2>/dev/null",
            path.c_str(), static_cast<char*>(nullptr));
    ::_exit(9);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST(MemoryFile, IsThereForAsLongAsItsObject) {
  std::string path;
  {
    auto made = MemoryFile::make("test", "content");
    ASSERT_TRUE(made);
    path = made->path();
    const MemoryFile moved = *std::move(made);
    EXPECT_EQ(moved.path(), path);
    EXPECT_TRUE(std::filesystem::exists(path));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace swarm::shell
