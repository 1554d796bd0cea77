// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/plan_keeper.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace swarm::planner {
namespace {

// After a start the launcher's scene is due at once; a bus that does not bring it must not keep a
// mission from flying.
constexpr Duration kScenePatience = std::chrono::seconds(3);
constexpr double kFew = 0.05;  // of the robots: no plan of their own
// A planner that comes back in mid-flight waits this long for robots it does not hear.
constexpr Duration kHearPatience = std::chrono::milliseconds(1500);
// Robots that stand for this long are stuck; escapes of their own have not helped by then.
constexpr Duration kStuckAfter = std::chrono::seconds(8);
// … and so many of them are reason to lead the swarm another way.
constexpr double kStuckShare = 0.1;
// While obstacles move, and while there is no plan for the scene.
constexpr Duration kReplanPeriod = std::chrono::seconds(2);

}  // namespace

PlanKeeper::PlanKeeper(const Mission& mission, std::uint64_t seed, StageClock clock)
    : mission_(mission),
      seed_(seed),
      clock_(std::move(clock)),
      planner_(planner_options(mission)),
      robots_(mission.robots.count, from_seconds(3.0 + 3.0 / mission.link.status_hz)),
      scene_(first_scene(mission.world.obstacles().size())) {}

Result<void> PlanKeeper::plan_first() {
  Rng rng(seed_);
  auto planned = planner_.plan({mission_.world, mission_.start, mission_.goal}, rng, clock_);
  if (!planned) return tl::unexpected(planned.error());
  newest_ = {*std::move(planned), {}};
  return {};
}

bool PlanKeeper::take_scene(Scene scene) {
  if (scene_heard_ && scene.version <= scene_.version) return false;
  scene_ = std::move(scene);
  scene_heard_ = true;
  return true;
}

/// From where the robots are, once they have left their start; before, the mission's own mixture is
/// the truth they were placed by.
Result<Replan> PlanKeeper::plan_anew(UtcTime utc, std::span<const HeardRobot> heard) {
  const World world = world_during(mission_.world, scene_, utc, kReplanPeriod);
  const Mixture& goal = scene_.goal ? *scene_.goal : mission_.goal;
  planner_.set_risk({.alpha = scene_.risk_alpha.value_or(mission_.planner.risk_alpha),
                     .delta_m = mission_.planner.risk_delta_m});
  Rng rng(mix_seed(seed_, version_));
  if (phase_ != MissionPhase::kReady) {
    return replan(planner_, world, goal, heard, mission_.robots.count, rng, clock_);
  }
  auto planned = planner_.plan({world, mission_.start, goal}, rng, clock_);
  if (!planned) return tl::unexpected(planned.error());
  return Replan{*std::move(planned), {}};
}

void PlanKeeper::try_again(SteadyTime now, UtcTime utc, Step& step) {
  const std::vector<HeardRobot> heard = robots_.fresh(now);
  if (phase_ != MissionPhase::kReady) {
    if (heard.empty() || (!robots_.heard_all(now) && now - begun_at_ < kHearPatience)) return;
  }
  tried_at_ = now;
  auto planned = plan_anew(utc, heard);
  if (!planned) {
    if (failed_scene_ == scene_.version) return;
    failed_scene_ = scene_.version;
    std::string why = planned.error().message;
    for (std::size_t at = 0; (at = why.find('\n', at)) != std::string::npos;) {
      why.replace(at, 1, "; ");  // a notice is one line
    }
    step.notices.push_back({true, "replan-failed", "the last plan stays: " + why});
    return;
  }
  newest_ = *std::move(planned);
  publish(step);
}

void PlanKeeper::keep_planned(SteadyTime now, UtcTime utc, Step& step) {
  if (!scene_heard_ && now - begun_at_ < kScenePatience) return;
  const bool published = version_ > 0;
  if (scene_.version == 0 && !published) {
    publish(step);
    tried_at_ = now;
    return;
  }
  const bool news = !published || scene_.version != planned_scene_;
  const bool tried = failed_scene_ == scene_.version;
  const bool due = now - tried_at_ >= kReplanPeriod;
  if ((news && (!tried || due)) || (scene_.moves(utc) && due) || is_step_due(now)) {
    try_again(now, utc, step);
  }
}

/// ROVER plans anew at every step, but not for the last few: to one robot each plan gives another
/// goal, whichever lacks a share, and it would fly to and fro for good.
bool PlanKeeper::is_step_due(SteadyTime now) const {
  if (mission_.planner.method != "rover" || phase_ != MissionPhase::kRunning) return false;
  const double step_s = mission_.planner.transport_radius_m / mission_.planner.speed_mps;
  if (now - tried_at_ < from_seconds(step_s)) return false;
  const std::vector<HeardRobot> heard = robots_.fresh(now);
  const auto left =
      std::count_if(heard.begin(), heard.end(), [](const HeardRobot& r) { return !r.arrived; });
  return static_cast<double>(left) > std::max(1.0, kFew * static_cast<double>(heard.size()));
}

/// CRoPS: where many are stuck the guide becomes dear, and may lead another way.
void PlanKeeper::avoid_jams(SteadyTime now, UtcTime utc, Step& step) {
  if (phase_ != MissionPhase::kRunning) return;
  const std::vector<HeardRobot> stuck = robots_.stuck(now, kStuckAfter);
  if (stuck.empty() || static_cast<double>(stuck.size()) < kStuckShare * mission_.robots.count) {
    return;
  }
  robots_.forgive(now);
  const Vec2& at_m = stuck[stuck.size() / 2].position_m;
  if (!planner_.avoid(at_m)) return;
  step.notices.push_back(
      {false, "jam",
       fmt::format("{} robots are stuck, about ({:.1f}, {:.1f}) m: the guide leads another way",
                   stuck.size(), at_m.x(), at_m.y())});
  try_again(now, utc, step);
}

void PlanKeeper::publish(Step& step) {
  step.publish = true;
  ++version_;
  planned_scene_ = scene_.version;
}

PlanKeeper::Step PlanKeeper::step(SteadyTime now, UtcTime utc) {
  Step step;
  keep_planned(now, utc, step);
  avoid_jams(now, utc, step);
  return step;
}

}  // namespace swarm::planner
