// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// An agent is killed and its successor gets the same process id, of which DDS makes its identifier.
// Needs root, for process ids of its own.
#include <algorithm>
#include <csignal>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <sys/wait.h>

#include "swarm_launcher/processes/child_process.hpp"
#include "tests/faults/edited_mission.hpp"

namespace swarm::test {
namespace {

/// The id of a process in the innermost namespace that it is in; 0 once it is gone.
pid_t inner_pid(pid_t pid) {
  const std::string status = read_text("/proc/" + std::to_string(pid) + "/status");
  const std::size_t at = status.find("NSpid:");
  if (at == std::string::npos) return 0;
  std::istringstream line(status.substr(at + 6, status.find('\n', at) - at - 6));
  pid_t inner = 0;
  for (pid_t next = 0; line >> next;) inner = next;
  return inner;
}

/// Makes the next process id in a namespace `pid`, until it is destroyed.
class NextPid {
 public:
  NextPid(pid_t in_namespace, pid_t pid)
      : writer_(launcher::start_process(
            {"/usr/bin/nsenter", "--target", std::to_string(in_namespace), "--pid", "/bin/sh", "-c",
             "while :; do echo " + std::to_string(pid - 1) +
                 " >/proc/sys/kernel/ns_last_pid || exit; done"},
            "/dev/null")) {}
  ~NextPid() {
    if (!writer_) return;
    for (const Child& child : children_of(*writer_)) ::kill(child.pid, SIGKILL);
    ::kill(*writer_, SIGKILL);
    ::waitpid(*writer_, nullptr, 0);
  }
  NextPid(const NextPid&) = delete;
  NextPid& operator=(const NextPid&) = delete;

 private:
  Result<pid_t> writer_;
};

class SamePid : public testing::TestWithParam<const char*> {
 protected:
  bool begin() {
    const auto started = launcher::start_process(
        {"/usr/bin/unshare", "--pid", "--fork", "--kill-child", "--mount-proc",
         std::string(SWARM_BIN_DIR) + "/swarm_launcher", "run", mission_.file().string(), "--out",
         dir().string(), "--channel", GetParam()},
        log());
    outer_ = started.value_or(0);
    eventually([&] {
      const auto children = children_of(outer_, "swarm_launcher");
      launcher_ = children.empty() ? 0 : children.front();
      return launcher_ != 0 || ::kill(outer_, 0) != 0 || has_ended();
    });
    return launcher_ != 0;
  }
  void TearDown() override {
    if (outer_ > 0 && !exit_code_) ::kill(outer_, SIGKILL);
  }
  std::filesystem::path dir() const { return folder_.path() / "run"; }
  std::filesystem::path log() const { return folder_.path() / "log"; }
  pid_t launcher() const { return launcher_; }

  /// Kills the agent with the smallest id, and waits for its successor. Whether it has its id.
  bool replace_an_agent() {
    const auto before = children_of(launcher_, "robot_agent");
    const pid_t killed = before.front(), inner = inner_pid(killed);
    ::kill(killed, SIGKILL);
    const NextPid same(launcher_, inner);
    std::vector<pid_t> after;
    eventually([&] {
      after = children_of(launcher_, "robot_agent");
      return after.size() == before.size() &&
             std::find(after.begin(), after.end(), killed) == after.end();
    });
    return std::any_of(after.begin(), after.end(),
                       [&](pid_t pid) { return inner_pid(pid) == inner; });
  }
  int wait() {
    eventually([&] { return has_ended(); }, std::chrono::seconds(240));
    return exit_code_.value_or(-1);
  }

 private:
  bool has_ended() {
    int status = 0;
    if (!exit_code_ && ::waitpid(outer_, &status, WNOHANG) == outer_) {
      exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    return exit_code_.has_value();
  }

  TemporaryFolder folder_;
  EditedMission mission_{"  respawn_agent_max: 9\n"};
  pid_t outer_ = 0, launcher_ = 0;
  std::optional<int> exit_code_;
};

TEST_P(SamePid, OfARestartedAgentDoesNotHideIt) {
  if (!begin()) GTEST_SKIP() << "needs root: " << read_text(log());
  ASSERT_TRUE(eventually([&] { return has_event(dir(), "command"); })) << read_text(log());

  bool same = false;
  for (int i = 0; i < 6 && !same; ++i) same = replace_an_agent();
  ASSERT_TRUE(same) << "other processes took the id each time";

  EXPECT_EQ(wait(), 0) << read_text(log());
  const auto summary = nlohmann::json::parse(read_text(dir() / "summary.json"), nullptr, false);
  EXPECT_EQ(summary["arrived"], 12);
  EXPECT_EQ(summary["collisions_robot"], 0);
}

INSTANTIATE_TEST_SUITE_P(Channels, SamePid, testing::Values("topics", "groups"));

}  // namespace
}  // namespace swarm::test
