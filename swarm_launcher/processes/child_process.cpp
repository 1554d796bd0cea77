// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/processes/child_process.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace swarm::launcher {
namespace {

constexpr int kUrgentNice = -10;
constexpr int kChildNice = 5;  // above the launcher's
// Exit code of a child that could not execute its program, as in shells.
constexpr int kExecFailed = 127;

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

}  // namespace

void become_urgent() { ::setpriority(PRIO_PROCESS, 0, kUrgentNice); }

// Not on a terminal that is stopped or a full pipe, which would stop the caller.
void warn(const std::string& text) {
  pollfd output{.fd = STDERR_FILENO, .events = POLLOUT, .revents = 0};
  if (::poll(&output, 1, 0) == 1 && (output.revents & POLLOUT) != 0) {
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), text.size());
  }
}

// A child that cannot log is started all the same: a full disk must not end a flight. The log of a
// child that is restarted exists: without O_CREAT a frozen file system opens it, too.
int open_log(const std::filesystem::path& log) {
  constexpr int kHow = O_WRONLY | O_APPEND | O_CLOEXEC;
  int fd = ::open(log.c_str(), kHow);
  if (fd < 0 && errno == ENOENT) {
    std::error_code error;
    std::filesystem::create_directories(log.parent_path(), error);
    fd = ::open(log.c_str(), kHow | O_CREAT, 0644);
  }
  if (fd >= 0) return fd;
  warn(fmt::format("cannot open {}: {}; the process runs without a log\n", log.string(),
                   std::strerror(errno)));
  return ::open("/dev/null", O_WRONLY | O_CLOEXEC);
}

// When memory runs out, the kernel is to end a child, which can be restarted, and not the launcher.
// Only async-signal-safe calls.
void become_first_victim() {
  const int fd = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (fd < 0) return;
  constexpr std::string_view kScore = "500";
  [[maybe_unused]] const auto wrote = ::write(fd, kScore.data(), kScore.size());
  ::close(fd);
}

// fork() and exec() instead of posix_spawn(), which cannot set the parent-death signal.
Result<pid_t> start_process(const std::vector<std::string>& command_line,
                            const std::filesystem::path& log) {
  const int log_fd = open_log(log);
  std::vector<char*> argv;
  for (const std::string& word : command_line) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);

  const pid_t parent = ::getpid();
  // A stop signal between fork and exec would run the launcher's handler in the child and be lost.
  // So stop signals are blocked until the child has the default actions.
  sigset_t stops;
  sigset_t before;
  sigemptyset(&stops);
  sigaddset(&stops, SIGINT);
  sigaddset(&stops, SIGTERM);
  ::pthread_sigmask(SIG_BLOCK, &stops, &before);
  const pid_t pid = ::fork();
  if (pid == 0) {  // only async-signal-safe calls from here on: the launcher has threads
    ::signal(SIGINT, SIG_DFL);
    ::signal(SIGTERM, SIG_DFL);
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    // The launcher may have died before the death signal was set.
    if (::getppid() != parent) ::_exit(kExecFailed);
    ::setpriority(PRIO_PROCESS, 0, ::getpriority(PRIO_PROCESS, 0) + kChildNice);
    become_first_victim();
    ::dup2(log_fd, STDOUT_FILENO);
    ::dup2(log_fd, STDERR_FILENO);
    const int null_fd = ::open("/dev/null", O_RDONLY);
    if (null_fd >= 0) ::dup2(null_fd, STDIN_FILENO);
    // Sockets and files of the launcher stay with it, also those that libraries opened.
    ::close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
    ::execv(argv[0], argv.data());
    ::_exit(kExecFailed);
  }
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  ::close(log_fd);
  if (pid < 0) {
    return fail(ErrorCode::kEnvironment, fmt::format("cannot start {}: {}; see ulimit -u",
                                                     command_line.front(), std::strerror(errno)));
  }
  return pid;
}

int number_of(EndSignal signal) {
  switch (signal) {
    case EndSignal::kInterrupt:
      return SIGINT;
    case EndSignal::kTerminate:
      return SIGTERM;
    case EndSignal::kKill:
      return SIGKILL;
  }
  return SIGKILL;
}

// wait4(), because it also returns the resource usage of the child.
std::optional<ExitedChild> reap_child() {
  int status = 0;
  rusage usage = {};
  const pid_t pid = ::wait4(-1, &status, WNOHANG, &usage);
  if (pid <= 0) return std::nullopt;
  return ExitedChild{.pid = pid,
                     .exit = {.code = WIFEXITED(status) ? WEXITSTATUS(status) : 0,
                              .signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0},
                     .cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime),
                     .max_rss_mb = static_cast<double>(usage.ru_maxrss) / 1024.0};
}

void ChildSpawner::signal(pid_t pid, EndSignal signal) { ::kill(pid, number_of(signal)); }

// By the running executable, so that a build or installation uses its own programs.
std::filesystem::path sibling_program(const std::string& name) {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / name;
}

}  // namespace swarm::launcher
