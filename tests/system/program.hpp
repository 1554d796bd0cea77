// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

namespace swarm::test {

/// One of our programs in a process of its own, killed when the object is destroyed.
class Program {
 public:
  /// Starts `SWARM_BIN_DIR/name arguments…`; stdout and stderr go to files.
  Program(const std::string& name, const std::vector<std::string>& arguments);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  pid_t pid() const { return pid_; }
  void signal(int number) const;

  /// Waits for the end; its exit code, or 128 + the signal that killed it. The deadline is only a
  /// guard against hanging for ever: it fails the test.
  int wait(std::chrono::seconds guard = std::chrono::seconds(240));

  std::string out() const;
  std::string err() const;

 private:
  std::filesystem::path folder_;
  pid_t pid_ = -1;
  bool ended_ = false;
};

/// A fresh directory that is removed with the object (kept if the test failed).
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Process ids of the living children of a process, oldest first, with the name of their program.
struct Child {
  pid_t pid = 0;
  std::string program;
};
std::vector<Child> children_of(pid_t parent);
std::vector<pid_t> children_of(pid_t parent, const std::string& program);

/// Polls until the condition holds; false at the end of the time limit, which prevents an endless
/// loop.
template <class Condition>
bool eventually(Condition condition, std::chrono::seconds guard = std::chrono::seconds(120));

std::string read_text(const std::filesystem::path& file);

/// The address HOST:PORT for other hosts, which a launcher prints; empty if it never does.
std::string join_address(const Program& launcher);

/// Whether `events.jsonl` of a run has an event with this code.
bool has_event(const std::filesystem::path& run_dir, const std::string& code);

}  // namespace swarm::test

#include <thread>

template <class Condition>
bool swarm::test::eventually(Condition condition, std::chrono::seconds guard) {
  const auto deadline = std::chrono::steady_clock::now() + guard;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}
