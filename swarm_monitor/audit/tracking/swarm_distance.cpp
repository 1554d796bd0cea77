// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/swarm_distance.hpp"

#include "swarm_monitor/audit/tracking/swarm_walk.hpp"

namespace swarm::monitor {
namespace {

/// Seed of the samples, mixed with the moment's number; references are measured at every fourth
/// moment, since each costs a further assignment.
constexpr std::uint64_t kDistanceSeed = 19;
constexpr std::size_t kReferencesEvery = 4;

/// Sums of distances and floors, and their means.
class Mean {
 public:
  void add(const Distance& distance) {
    sum_.w2_m += distance.w2_m;
    sum_.floor_m += distance.floor_m;
    ++count_;
  }
  std::optional<Distance> mean() const {
    if (count_ == 0) return std::nullopt;
    const auto n = static_cast<double>(count_);
    return Distance{.w2_m = sum_.w2_m / n, .floor_m = sum_.floor_m / n};
  }

 private:
  Distance sum_{};
  std::size_t count_ = 0;
};

}  // namespace

/// The same sample serves as the target of the robots and in the floor, so that the scatter of that
/// sample cancels in their ratio in part.
std::vector<SwarmDistance> swarm_distances(const RecordedRun& run,
                                           std::span<const PlanMoment> moments,
                                           std::size_t most_robots) {
  std::vector<SwarmDistance> distances;
  SwarmWalk walk(run.tracks);
  for (std::size_t k = 0; k < moments.size(); ++k) {
    const PlanMoment& moment = moments[k];
    const std::vector<RobotNow>& living = walk.at(moment.time_s);
    if (living.empty()) continue;
    // Every n-th robot, so that at most `most_robots` enter the assignment, which is O(n³).
    const std::size_t every = (living.size() + most_robots - 1) / most_robots;
    std::vector<Vec2> positions, references;
    for (std::size_t i = 0; i < living.size(); i += every) {
      positions.push_back(living[i].position_m);
      if (living[i].step->plan_version != moment.published->version) continue;
      references.push_back(living[i].step->reference_m());
    }
    Rng rng(mix_seed(kDistanceSeed, k));
    const Mixture mixture = moment.mixture();
    const std::vector<Vec2> sample = fair_sample(mixture, positions.size(), rng);
    const std::vector<Vec2> other = fair_sample(mixture, positions.size(), rng);
    SwarmDistance distance{
        .time_s = moment.time_s,
        .plan_time_s = moment.plan_time_s,
        .plan_version = moment.published->version,
        .arrived_share = arrived_share(living),
        .robots = {.w2_m = w2_m(positions, sample), .floor_m = w2_m(other, sample)}};
    const bool looked_at = k % kReferencesEvery == 0 || k + 1 == moments.size();
    if (looked_at && references.size() * 10 >= positions.size() * 9) {
      const std::vector<Vec2> third = fair_sample(mixture, references.size(), rng);
      distance.references =
          Distance{.w2_m = w2_m(references, third), .floor_m = distance.robots.floor_m};
    }
    distances.push_back(distance);
  }
  return distances;
}

std::optional<Distance> mean_distance(std::span<const SwarmDistance> distances) {
  Mean mean;
  for (const SwarmDistance& distance : distances) mean.add(distance.robots);
  return mean.mean();
}

std::optional<Distance> mean_reference_distance(std::span<const SwarmDistance> distances) {
  Mean mean;
  for (const SwarmDistance& distance : distances) {
    if (distance.references) mean.add(*distance.references);
  }
  return mean.mean();
}

/// Consecutive moments of the same plan version form one entry: versions only grow over a run.
std::vector<PlanDistance> distances_by_plan(std::span<const SwarmDistance> distances) {
  std::vector<PlanDistance> plans;
  for (std::size_t begin = 0; begin < distances.size();) {
    const std::uint32_t version = distances[begin].plan_version;
    std::size_t end = begin;
    while (end < distances.size() && distances[end].plan_version == version) ++end;
    const auto mean = mean_distance(distances.subspan(begin, end - begin));
    plans.push_back({.plan_version = version, .moments = end - begin, .mean = *mean});
    begin = end;
  }
  return plans;
}

}  // namespace swarm::monitor
