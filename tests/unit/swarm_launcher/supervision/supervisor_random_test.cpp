// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The supervisor under random sequences of everything that can happen to a run. The test keeps its
// own record of the processes and checks every action against it.
#include <algorithm>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_launcher/supervision/supervisor.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;
using Stage = Supervisor::Stage;

/// What the test knows of a process.
struct Known {
  bool alive = false;
  std::uint32_t starts = 0;
  SteadyTime started_at;
  std::uint32_t deaths_in_a_row = 0;
  std::optional<EndSignal> signal{};
};

class Play {
 public:
  explicit Play(std::uint64_t seed) : rng_(seed) {
    options_.robots = static_cast<std::uint32_t>(1 + rng_() % 12);
    options_.per_process = static_cast<std::uint32_t>(1 + rng_() % 4);
    const std::uint32_t agents =
        (options_.robots + options_.per_process - 1) / options_.per_process;
    options_.remote_processes = rng_() % 3 == 0 ? static_cast<std::uint32_t>(rng_() % agents) : 0;
    options_.launcher.respawn_agent_max = static_cast<std::uint32_t>(rng_() % 3);
    options_.launcher.quorum_share = uniform01(rng_);
    options_.launcher.quorum_timeout_s = 5.0;
    options_.launcher.time_limit_s = 60.0;
    options_.script = {{3.0, CommandKind::kPause}, {5.0, CommandKind::kResume}};
    known_.resize(agents + 1);
    local_ = agents + 1 - options_.remote_processes;
    sut_.emplace(options_, now_);
  }

  /// Steps until the run is done; at the latest the time limit and the signals end it.
  void run() {
    for (int i = 0; i < 4000 && sut_->stage() != Stage::kDone; ++i) {
      happen();
      stage_before_ = sut_->stage();
      const Outcome outcome = sut_->outcome();
      const auto actions = sut_->step(now_);
      for (const Action& action : actions) check(action);
      EXPECT_GE(sut_->stage(), stage_before_) << "a stage never comes again";
      EXPECT_TRUE(outcome == Outcome::kNone || sut_->outcome() == outcome);
      EXPECT_EQ(sut_->outcome() != Outcome::kNone, sut_->stage() >= Stage::kEnding);
      check_counts();
      if (testing::Test::HasFailure()) return;
      now_ += milliseconds(rng_() % 20 == 0 ? 700 : 50);
    }
    EXPECT_EQ(sut_->stage(), Stage::kDone);
    EXPECT_TRUE(std::none_of(known_.begin(), known_.end(), [](const Known& p) { return p.alive; }));
    EXPECT_TRUE(sut_->step(now_).empty()) << "nothing is left to do";
  }

 private:
  /// A random event, often none.
  void happen() {
    const auto process = static_cast<std::uint32_t>(rng_() % known_.size());
    const RobotId robot(static_cast<std::uint32_t>(rng_() % options_.robots));
    switch (rng_() % 16) {
      case 0:
        if (rng_() % 4 == 0 && known_[process].alive) exit(process);
        break;
      case 1:
        if (rng_() % 8 == 0) sut_->on_silent(robot, now_);
        break;
      case 2:
        if (rng_() % 12 == 0) sut_->on_command(static_cast<CommandKind>(rng_() % 4), now_);
        break;
      case 3:
        if (rng_() % 40 == 0) sut_->on_interrupt();
        break;
      case 5:
        if (known_[0].alive) sut_->on_heartbeat(known_[0].starts);
        break;
      case 4:
        if (process >= local_ && !known_[process].alive && sut_->stage() <= Stage::kGathering) {
          known_[process].alive = true;
          sut_->on_joined(ProcessIndex(process), 1, now_);
        }
        break;
      default:
        sut_->on_status(robot, {.has_plan = rng_() % 8 != 0,
                                .receives_neighbours = rng_() % 8 != 0,
                                .mode = static_cast<RobotMode>(rng_() % 20 == 0 ? 4 : rng_() % 4),
                                .settled = rng_() % 2 == 0,
                                .sent_at = now_ - milliseconds(rng_() % 100),
                                .confirms_stop = rng_() % 20 == 0});
    }
  }

  void exit(std::uint32_t process) {
    known_[process].alive = false;
    constexpr int kCodes[] = {0, 1, 2, 3};
    sut_->on_exit(ProcessIndex(process),
                  {.code = kCodes[rng_() % 4], .signal = rng_() % 2 == 0 ? 9 : 0}, now_);
  }

  void check(const Action& action) {
    if (const auto* start = std::get_if<StartProcess>(&action)) {
      Known& p = known_.at(start->process.value());
      EXPECT_LT(start->process.value(), local_) << "another host's process";
      EXPECT_FALSE(p.alive) << "it runs already";
      EXPECT_LT(stage_before_, Stage::kEnding);
      // A process that was well may die again as often; the planner is always restarted in flight.
      p.deaths_in_a_row = now_ - p.started_at >= RestartPolicy::kWell ? 1 : p.deaths_in_a_row + 1;
      const bool is_first = p.starts++ == 0;
      EXPECT_TRUE(is_first || start->process == kPlanner ||
                  p.deaths_in_a_row <= options_.launcher.respawn_agent_max);
      if (is_first) p.deaths_in_a_row = 0;
      p.started_at = now_;
      EXPECT_TRUE(p.starts > 1 || start->process.value() == first_starts_++) << "in their order";
      p.alive = true;
    } else if (const auto* signal = std::get_if<SignalProcess>(&action)) {
      Known& p = known_.at(signal->process.value());
      if (sut_->stage() != Stage::kEnding) {  // a process that is silent
        EXPECT_TRUE(p.alive && signal->process.value() < local_);
        EXPECT_EQ(signal->signal, EndSignal::kKill);
        exit(signal->process.value());
        return;
      }
      EXPECT_TRUE(p.alive) << "a signal to another process, perhaps not ours";
      EXPECT_TRUE(!p.signal || *p.signal < signal->signal) << "only ever a stronger one";
      p.signal = signal->signal;
      if (signal->signal == EndSignal::kKill || rng_() % 2 == 0) exit(signal->process.value());
    } else if (const auto* command = std::get_if<SendCommand>(&action)) {
      EXPECT_LT(stage_before_, Stage::kEnding);
      phase_ = phase_after(phase_, command->kind);
    } else if (const auto* bodies = std::get_if<AddBodies>(&action)) {
      EXPECT_FALSE(bodies->robots.empty());
      EXPECT_FALSE(has_duplicates(bodies->robots));
    } else if (const auto* cleared = std::get_if<ClearBodies>(&action)) {
      EXPECT_FALSE(cleared->robots.empty());
      EXPECT_FALSE(has_duplicates(cleared->robots));
    }
  }

  static bool has_duplicates(std::vector<RobotId> robots) {
    std::sort(robots.begin(), robots.end());
    return std::adjacent_find(robots.begin(), robots.end()) != robots.end();
  }

  void check_counts() const {
    const Supervisor::Counts c = sut_->counts();
    EXPECT_EQ(c.lost, sut_->lost().size());
    const std::uint32_t living = options_.robots - c.lost;
    EXPECT_LE(c.ready, living);
    EXPECT_LE(c.arrived, living);
    EXPECT_LE(c.settled, living);
    EXPECT_LE(c.arrived + c.stopped, living) << "a robot has one mode";
    EXPECT_LE(c.started, known_.size());
    for (const RobotId robot : sut_->unstopped()) {
      EXPECT_TRUE(known_[1 + robot.value() / options_.per_process].alive);
    }
    EXPECT_TRUE(sut_->stage() >= Stage::kEnding || sut_->phase() == phase_);
  }

  Rng rng_;
  SteadyTime now_{std::chrono::seconds(50)};
  SupervisorOptions options_;
  std::vector<Known> known_;
  std::uint32_t local_ = 0;
  std::uint32_t first_starts_ = 0;
  Stage stage_before_ = Stage::kStarting;  // the last step
  MissionPhase phase_ = MissionPhase::kReady;
  std::optional<Supervisor> sut_;
};

TEST(SupervisorInRandomRuns, ActsOnlyWhereItMayAndAlwaysComesToTheEnd) {
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    Play(seed).run();
    ASSERT_FALSE(HasFailure()) << "seed " << seed;
  }
}

}  // namespace
}  // namespace swarm::launcher
