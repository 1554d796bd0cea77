// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/plan_time_watch.hpp"

#include <algorithm>

namespace swarm::agent {

/// Age of a heartbeat by a minimum filter: receipt minus stamp is clock difference plus delay, and
/// its minimum over one to two windows stands for the clock difference. Two windows in turn need no
/// list of samples.
double PlanTimeWatch::age_s(const Beat& beat, SteadyTime now) {
  const std::int64_t now_ns = now.time_since_epoch().count();
  const std::int64_t apart_ns = now_ns - beat.stamp_utc_ns;
  const auto restart = [&] {
    any_ = true;
    window_began_ns_ = now_ns;
    least_ns_ = least_before_ns_ = apart_ns;
  };
  if (!any_) restart();
  if (now_ns - window_began_ns_ > static_cast<std::int64_t>(kWindow_s * 1e9)) {
    window_began_ns_ = now_ns;
    least_before_ns_ = least_ns_;
    least_ns_ = apart_ns;
  }
  least_ns_ = std::min(least_ns_, apart_ns);
  const double age = 1e-9 * static_cast<double>(apart_ns - std::min(least_ns_, least_before_ns_));
  // The planner's clock was set back: all samples so far are worthless.
  if (age <= kOldest_s) return age;
  restart();
  return 0.0;
}

/// Extrapolates the plan time to the receipt. A heartbeat of another version is kept: it may arrive
/// before its plan.
void PlanTimeWatch::on_heartbeat(const Beat& beat, SteadyTime now) {
  const Received received{.version = beat.version,
                          .plan_time_s = beat.plan_time_s + beat.rate * age_s(beat, now),
                          .rate = beat.rate,
                          .at = now};
  (beat.version == version_ ? received_ : other_) = received;
}

/// The same flow keeps the highest plan time, so that it does not go back. Another flow starts over
/// even under the same version: a restarted planner may begin with version 1 again, and its
/// predecessor's last heartbeat has the plan time of the flow before.
void PlanTimeWatch::on_plan(std::uint32_t version, bool same_flow) {
  if (!same_flow) {
    highest_s_ = 0.0;
    received_.reset();
  }
  if (version == version_) return;
  version_ = version;
  if (other_ && other_->version == version) received_ = other_;
  other_.reset();
}

/// Extrapolates at the rate received last, up to the silence. While the plan time is held at its
/// highest value, its rate is 0.
std::optional<PlanTime> PlanTimeWatch::at(SteadyTime now) {
  if (!received_) return std::nullopt;
  const Duration since = std::min(now - received_->at, silence_);
  const double time_s = received_->plan_time_s + received_->rate * to_seconds(since);
  const bool runs = now - received_->at <= silence_ && time_s >= highest_s_;
  highest_s_ = std::max(highest_s_, time_s);
  return PlanTime{.plan_time_s = highest_s_, .rate = runs ? received_->rate : 0.0};
}

}  // namespace swarm::agent
