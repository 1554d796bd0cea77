// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Memory that runs out: the kernel ends a child of the launcher, and not the launcher.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <system_error>

#include <unistd.h>

#include "tests/system/flown_run.hpp"

namespace swarm::test {
namespace {

namespace fs = std::filesystem;

/// A control group with a memory limit, of either version of the kernel's interface.
class MemoryGroup {
 public:
  /// Empty where the machine does not allow it: it needs root.
  static std::optional<fs::path> make(const std::string& limit) {
    const std::string name = "swarmflow-test-" + std::to_string(::getpid());
    const struct {
      fs::path parent;
      const char* limit;
    } interfaces[] = {{"/sys/fs/cgroup/memory", "memory.limit_in_bytes"},
                      {"/sys/fs/cgroup", "memory.max"}};
    for (const auto& interface : interfaces) {
      std::error_code error;
      const fs::path group = interface.parent / name;
      if (!fs::create_directory(group, error)) continue;
      std::ofstream out(group / interface.limit);
      if (fs::exists(group / interface.limit, error) && out << limit << std::flush) return group;
      fs::remove(group, error);
    }
    return std::nullopt;
  }

  explicit MemoryGroup(fs::path path) : path_(std::move(path)) {}
  ~MemoryGroup() {
    eventually(
        [&] {
          std::error_code error;
          return fs::remove(path_, error);  // once its last process has ended
        },
        std::chrono::seconds(10));
  }
  MemoryGroup(const MemoryGroup&) = delete;
  MemoryGroup& operator=(const MemoryGroup&) = delete;

  bool take(pid_t pid) const {
    return static_cast<bool>(std::ofstream(path_ / "cgroup.procs") << pid << std::flush);
  }

 private:
  fs::path path_;
};

// Enough for the launcher, and not for the planner and twelve agents.
TEST(MemoryLimit, EndsChildrenAndNotTheLauncher) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "with a sanitizer the launcher alone needs more";
#endif
  const auto group = MemoryGroup::make("36M");
  if (!group) GTEST_SKIP() << "no control group for memory can be made here";
  const MemoryGroup limited(*group);
  FlownRun run;
  ASSERT_TRUE(limited.take(run.launcher().pid()));

  EXPECT_TRUE(eventually([&] {
    return read_text(run.dir() / "events.jsonl").find("killed by signal 9") != std::string::npos;
  })) << run.outcome();
  run.launcher().signal(SIGINT);

  EXPECT_LT(run.launcher().wait(), 128) << "it ends by itself, with a summary";
  EXPECT_TRUE(run.summary()["outcome"].is_string());
}

}  // namespace
}  // namespace swarm::test
