// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/host_pair.hpp"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "swarm_launcher/processes/child_process.hpp"

namespace swarm::launcher {
namespace {

constexpr const char* kCable = "cable";

int own_network() { return ::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC); }

bool enter(int network) { return ::setns(network, CLONE_NEWNET) == 0; }

}  // namespace

Result<std::unique_ptr<HostPair>> HostPair::make() {
  std::unique_ptr<HostPair> pair(new HostPair);
  if (auto done = pair->set_up(); !done) return tl::unexpected(done.error());
  return pair;
}

HostPair::~HostPair() {
  if (home_ >= 0) enter(home_);  // after a failure this thread may be in one of the others
  for (const int fd : {home_, networks_[0], networks_[1]}) {
    if (fd >= 0) ::close(fd);
  }
}

// One end of the cable goes to the network of a process, and this one enters the second network for
// that: `ip` knows namespaces by name, which outlive their processes, or by process.
Result<void> HostPair::set_up() {
  home_ = own_network();
  for (int& network : networks_) {
    if (::unshare(CLONE_NEWNET) != 0) {
      return fail(ErrorCode::kEnvironment,
                  fmt::format("needs root, for networks of its own: {}", std::strerror(errno)));
    }
    network = own_network();
  }
  bool made = ip(Host::kFirst, {"link", "add", kCable, "type", "veth", "peer", "name", kCable,
                                "netns", fmt::format("{}", ::getpid())});
  if (!enter(home_)) made = false;
  for (const Host host : {Host::kFirst, Host::kSecond}) {
    made = made && ip(host, {"link", "set", "lo", "up"}) &&
           ip(host, {"addr", "add", address(host) + "/24", "dev", kCable}) &&
           ip(host, {"link", "set", kCable, "up"});
  }
  if (!made) return fail(ErrorCode::kEnvironment, "needs iproute2, for a cable between two hosts");
  if (!wait_until_running()) {
    return fail(ErrorCode::kEnvironment, "the cable between two hosts does not come up");
  }
  return {};
}

/// The kernel takes up to a second to report a cable as running, and DDS uses only interfaces that
/// run.
bool HostPair::wait_until_running() const {
  for (int tries = 0; tries < 100; ++tries) {
    if (is_running(Host::kFirst) && is_running(Host::kSecond)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

bool HostPair::is_running(Host host) const {
  if (!enter(at(host))) return false;
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool is_back = enter(home_);
  ifreq request{};
  std::strncpy(request.ifr_name, kCable, sizeof request.ifr_name - 1);
  const bool is_known = ::ioctl(socket, SIOCGIFFLAGS, &request) == 0;
  ::close(socket);
  return is_back && is_known && (request.ifr_flags & IFF_RUNNING) != 0;
}

bool HostPair::ip(Host host, std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(), "ip");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const pid_t pid = ::fork();
  if (pid == 0) {
    const int null_fd = ::open("/dev/null", O_RDWR);
    ::dup2(null_fd, STDOUT_FILENO);
    ::dup2(null_fd, STDERR_FILENO);
    if (enter(at(host))) ::execvp(argv[0], argv.data());
    ::_exit(127);
  }
  int status = -1;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return pid > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

Result<pid_t> HostPair::start(Host host, const std::vector<std::string>& command_line,
                              const std::filesystem::path& log) const {
  if (!enter(at(host))) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("cannot enter a network namespace: {}", std::strerror(errno)));
  }
  auto pid = start_process(command_line, log);
  enter(home_);
  return pid;
}

// At the second host: its programs see a network that is down, those of the first one that nothing
// answers.
bool HostPair::pull_cable() {
  if (is_pulled_) return false;
  is_pulled_ = ip(Host::kSecond, {"link", "set", kCable, "down"});
  return is_pulled_;
}

void HostPair::plug_cable() {
  if (is_pulled_) ip(Host::kSecond, {"link", "set", kCable, "up"});
  is_pulled_ = false;
}

}  // namespace swarm::launcher
