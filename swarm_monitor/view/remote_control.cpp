// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/remote_control.hpp"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <random>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/app/control_socket.hpp"

namespace swarm::monitor {

/// A new goal keeps weights and covariances of the present one; all means move by the same vector,
/// so that the mixture's mean is at the clicked point.
std::string command_line_of(const ControlRequest& request, const Mixture& goal) {
  switch (request.action) {
    case ControlAction::kPause:
      return "pause";
    case ControlAction::kResume:
      return "resume";
    case ControlAction::kStop:
      return "stop";
    case ControlAction::kAddObstacle:
      return fmt::format("add_obstacle circle_m: {{center: [{}, {}], radius: {}}}", request.x_m,
                         request.y_m, request.radius_m);
    case ControlAction::kGoal:
      break;
  }
  Vec2 mean = Vec2::Zero();
  for (const WeightedGaussian& c : goal.components()) mean += c.weight * c.gaussian.mean_m();
  const Vec2 shift = Vec2(request.x_m, request.y_m) - mean;
  std::string list;
  for (const WeightedGaussian& c : goal.components()) {
    const Vec2 at = c.gaussian.mean_m() + shift;
    const Mat2& s = c.gaussian.covariance_m2();
    list += fmt::format("{}{{mean_m: [{}, {}], covariance_m2: [[{}, {}], [{}, {}]], weight: {}}}",
                        list.empty() ? "" : ", ", at.x(), at.y(), s(0, 0), s(0, 1), s(1, 0),
                        s(1, 1), c.weight);
  }
  return fmt::format("goto goal: [{}]", list);
}

/// A thread with a bounded queue of command lines. The launcher answers a command when it is done,
/// which may take seconds, and the view must keep serving.
class RemoteControl::Worker {
 public:
  explicit Worker(std::filesystem::path run_dir)
      : run_dir_(std::move(run_dir)), thread_([this] { work(); }) {}

  ~Worker() {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }

  // False if 16 commands wait: the launcher does not answer.
  bool post(std::string line) {
    constexpr std::size_t kMost = 16;
    {
      const std::lock_guard lock(mutex_);
      if (lines_.size() == kMost) return false;
      lines_.push_back(std::move(line));
    }
    wake_.notify_one();
    return true;
  }

 private:
  void work() {
    std::unique_lock lock(mutex_);
    while (!ended_) {
      if (lines_.empty()) {
        wake_.wait(lock);
        continue;
      }
      const std::string line = std::move(lines_.front());
      lines_.pop_front();
      lock.unlock();
      const auto done = shell::send_command(run_dir_, line, [](const std::string& sent) {
        std::fprintf(stderr, "launcher: %s\n", sent.c_str());
      });
      if (!done) std::fprintf(stderr, "%s: %s\n", line.c_str(), done.error().message.c_str());
      lock.lock();
    }
  }

  std::filesystem::path run_dir_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::string> lines_;
  bool ended_ = false;
  std::thread thread_;  // last: it uses all the others
};

RemoteControl::RemoteControl(std::filesystem::path run_dir, const LiveSource& source)
    : source_(source), worker_(std::make_unique<Worker>(std::move(run_dir))) {}

RemoteControl::~RemoteControl() = default;

Result<std::string> RemoteControl::ask(const ControlRequest& request) {
  const std::string line = command_line_of(request, source_.goal());
  if (!worker_->post(line)) {
    return fail(ErrorCode::kEnvironment, "the launcher has not answered what was asked before");
  }
  return "asked the launcher: " + line.substr(0, line.find(' '));
}

/// 128 random bits of std::random_device in hexadecimal.
std::string make_token() {
  std::random_device device;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", device());
  return token;
}

}  // namespace swarm::monitor
