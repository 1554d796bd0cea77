// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "program.hpp"

#include <csignal>
#include <fstream>
#include <sstream>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace swarm::test {
namespace {

std::filesystem::path new_folder() {
  const std::string to_fill_in(6, 'X');
  std::string pattern =
      (std::filesystem::temp_directory_path() / ("swarmflow-" + to_fill_in)).string();
  return ::mkdtemp(pattern.data());
}

}  // namespace

Program::Program(const std::string& name, const std::vector<std::string>& arguments) {
  folder_ = new_folder();
  std::vector<std::string> command_line = {std::string(SWARM_BIN_DIR) + "/" + name};
  command_line.insert(command_line.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& argument : command_line) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const std::string out = folder_ / "out";
  const std::string err = folder_ / "err";
  pid_ = ::fork();
  if (pid_ == 0) {
    ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
    ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
}

Program::~Program() {
  if (!ended_ && pid_ > 0) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void Program::signal(int number) const { ::kill(pid_, number); }

int Program::wait(std::chrono::seconds guard) {
  int status = 0;
  const bool ended = eventually([&] { return ::waitpid(pid_, &status, WNOHANG) == pid_; }, guard);
  if (!ended) {
    ADD_FAILURE() << "still running; stderr so far:\n" << err();
    return -1;
  }
  ended_ = true;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string Program::out() const { return read_text(folder_ / "out"); }
std::string Program::err() const { return read_text(folder_ / "err"); }

TemporaryFolder::TemporaryFolder() { path_ = new_folder(); }

TemporaryFolder::~TemporaryFolder() {
  if (::testing::Test::HasFailure()) return;
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::vector<Child> children_of(pid_t parent) {
  const std::string pid = std::to_string(parent);
  std::ifstream in("/proc/" + pid + "/task/" + pid + "/children");
  std::vector<Child> children;
  for (pid_t child = 0; in >> child;) {
    std::error_code gone;
    const auto exe = std::filesystem::read_symlink("/proc/" + std::to_string(child) + "/exe", gone);
    if (!gone) children.push_back({child, exe.filename()});
  }
  return children;
}

std::vector<pid_t> children_of(pid_t parent, const std::string& program) {
  std::vector<pid_t> pids;
  for (const Child& child : children_of(parent)) {
    if (child.program == program) pids.push_back(child.pid);
  }
  return pids;
}

std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string join_address(const Program& launcher) {
  const std::string before = "swarm_launcher join ";
  std::string err;
  if (!eventually([&] { return (err = launcher.err()).find(before) != std::string::npos; }))
    return "";
  const std::size_t begin = err.find(before) + before.size();
  return err.substr(begin, err.find_first_of(" \n", begin) - begin);
}

bool has_event(const std::filesystem::path& run_dir, const std::string& code) {
  return read_text(run_dir / "events.jsonl").find("\"code\":\"" + code + "\"") != std::string::npos;
}

}  // namespace swarm::test
