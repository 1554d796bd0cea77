// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/live_roadmap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "planner_service/roadmap/connect.hpp"
#include "planner_service/roadmap/means.hpp"
#include "swarm_core/gmm/same_gaussian.hpp"
#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {
namespace {

// Marks a sample that was removed, or a terminal that was not there before.
constexpr std::uint32_t kLost = std::numeric_limits<std::uint32_t>::max();
// Random points at least kSpacing · d apart, drawn until no more fit, have the density 1/d²: random
// sequential packing of discs covers 0.547 of the plane, and √(0.547 · 4/π) = 0.83.
constexpr double kSpacing = 0.83;
// Tries for each point that fits: enough to fill nine tenths of the gaps.
constexpr double kLiveTriesPerSample = 6.0;
constexpr int kAreaGrid = 32;

Box inflated(const Box& box, double by_m) {
  const Vec2 by = Vec2::Constant(by_m);
  return {box.min_m - by, box.max_m + by};
}

Box intersection(const Box& a, const Box& b) {
  return {a.min_m.cwiseMax(b.min_m), a.max_m.cwiseMin(b.max_m)};
}

double area_m2(const Box& box) {
  const Vec2 size_m = (box.max_m - box.min_m).cwiseMax(0.0);
  return size_m.x() * size_m.y();
}

Box path_box(const Gaussian& a, const Gaussian& b) {
  return {a.mean_m().cwiseMin(b.mean_m()), a.mean_m().cwiseMax(b.mean_m())};
}

// Free area by counting the free centres of a grid: the density of samples is a rough number
// anyway.
double free_area_m2(const World& world, double clearance_m) {
  const Vec2 step = (world.bounds_m().max_m - world.bounds_m().min_m) / kAreaGrid;
  int free = 0;
  for (int row = 0; row < kAreaGrid; ++row) {
    for (int column = 0; column < kAreaGrid; ++column) {
      const Vec2 at = world.bounds_m().min_m + step.cwiseProduct(Vec2(column + 0.5, row + 0.5));
      free += world.is_clear(at, std::max(0.0, clearance_m)) ? 1 : 0;
    }
  }
  return step.x() * step.y() * std::max(1, free);
}

}  // namespace

// Samples, then checks all pairs within the radius. Blocked pairs are kept as candidates: they
// become free when an obstacle goes.
LiveRoadmap::LiveRoadmap(World world, std::vector<Gaussian> terminals,
                         const LiveRoadmapOptions& options, Rng& rng)
    : options_(options),
      k_(cvar_coefficient(options.risk.alpha)),
      world_(std::make_unique<const World>(std::move(world))),
      checker_(*world_, options.risk, options.scale) {
  samples_ = sample_free(*world_, options.risk, options.sampler, options.samples, rng);
  work_.samples_drawn = samples_.size();
  const double clearance_m = k_ * options.sampler.sigma_min_m - options.risk.delta_m;
  density_per_m2_ = static_cast<double>(samples_.size()) / free_area_m2(*world_, clearance_m);
  for (const Gaussian& sample : samples_) sigma_max_m_.push_back(sample.max_sigma_m());
  std::vector<EdgeEnd> ends(samples_.begin(), samples_.end());
  for (const NeighbourPair& pair : find_neighbours(samples_, options.connection_radius_m)) {
    ++work_.edges_checked;
    sample_pairs_.push_back(
        {pair, checker_.is_free(ends[pair.a], ends[pair.b], kBuildTolerance_m)});
  }
  connect_terminals(std::move(terminals));
}

// The order matters: samples are removed before their pairs are checked, and new samples are drawn
// last, so that their pairs are checked against the present world once.
void LiveRoadmap::update(World world, std::vector<Gaussian> terminals, Rng& rng) {
  work_ = {};
  WorldChange change = world_change(*world_, world);
  auto next = std::make_unique<const World>(std::move(world));
  checker_.set_world(*next);
  world_ = std::move(next);
  added_ = BoxIndex(std::move(change.added));
  removed_ = BoxIndex(std::move(change.removed));
  if (!added_.boxes().empty() || !removed_.boxes().empty()) {
    const std::size_t before = samples_.size();
    lose_samples();
    recheck_pairs();
    draw_samples(before, rng);
  }
  connect_terminals(std::move(terminals));
}

bool LiveRoadmap::check(const Gaussian& a, const Gaussian& b) {
  ++work_.edges_checked;
  return checker_.is_free(a, b, kBuildTolerance_m);
}

// A free edge can be blocked by a new obstacle only, a blocked one freed by a removed one only.
bool LiveRoadmap::needs_check(const Gaussian& a, const Gaussian& b, double sigma_max_m,
                              bool free) const {
  const BoxIndex& changed = free ? added_ : removed_;
  return changed.any_within(path_box(a, b), checker_.reach_m(sigma_max_m),
                            [](std::uint32_t) { return true; });
}

// Removes samples that violate the risk limit beside a new obstacle, closes the gaps in their
// numbers and renumbers the pairs. The order of the samples stays.
void LiveRoadmap::lose_samples() {
  std::vector<std::uint32_t> renamed(samples_.size());
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < samples_.size(); ++i) {
    const Vec2& mean_m = samples_[i].mean_m();
    const bool near = added_.any_within({mean_m, mean_m}, checker_.reach_m(sigma_max_m_[i]),
                                        [](std::uint32_t) { return true; });
    if (near && !in_free(samples_[i], *world_, k_, options_.risk.delta_m)) {
      renamed[i] = kLost;
      continue;
    }
    renamed[i] = kept;
    samples_[kept] = samples_[i];
    sigma_max_m_[kept] = sigma_max_m_[i];
    ++kept;
  }
  work_.samples_lost = samples_.size() - kept;
  if (work_.samples_lost == 0) return;
  samples_.erase(samples_.begin() + kept, samples_.end());
  sigma_max_m_.resize(kept);
  std::erase_if(sample_pairs_, [&](Candidate& candidate) {
    candidate.pair.a = renamed[candidate.pair.a];
    candidate.pair.b = renamed[candidate.pair.b];
    return candidate.pair.a == kLost || candidate.pair.b == kLost;
  });
  const auto terminals = static_cast<std::uint32_t>(terminals_.size());
  for (std::vector<Candidate>& pairs : terminal_pairs_) {
    std::erase_if(pairs, [&](Candidate& candidate) {
      if (candidate.pair.b < terminals) return false;
      const std::uint32_t sample = renamed[candidate.pair.b - terminals];
      if (sample == kLost) return true;
      candidate.pair.b = terminals + sample;
      return false;
    });
  }
}

void LiveRoadmap::recheck_pairs() {
  // An edge that a change can affect has both its ends within the connection radius (plus the reach
  // of the risk) of the change: most edges are ruled out by their first end.
  double widest_m = 0.0;
  for (const double sigma_max_m : sigma_max_m_) widest_m = std::max(widest_m, sigma_max_m);
  const double reach_m = options_.connection_radius_m + checker_.reach_m(widest_m);
  std::vector<char> is_near(samples_.size());
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Box at{samples_[i].mean_m(), samples_[i].mean_m()};
    const auto yes = [](std::uint32_t) { return true; };
    is_near[i] = added_.any_within(at, reach_m, yes) || removed_.any_within(at, reach_m, yes);
  }
  for (Candidate& candidate : sample_pairs_) {
    const auto [a, b, distance_m] = candidate.pair;
    if (is_near[a] == 0 || is_near[b] == 0) continue;
    const double sigma_max_m = std::max(sigma_max_m_[a], sigma_max_m_[b]);
    if (!needs_check(samples_[a], samples_[b], sigma_max_m, candidate.free)) continue;
    candidate.free = check(samples_[a], samples_[b]);
  }
}

// Fills the space of removed obstacles to the density of the beginning. Samples lost to new
// obstacles are drawn again around these, where passages are narrow now, while the roadmap is not
// larger than it was before.
void LiveRoadmap::draw_samples(std::size_t before, Rng& rng) {
  const std::size_t first = samples_.size();
  const double spacing_m = kSpacing / std::sqrt(density_per_m2_);
  const double reach_m = checker_.reach_m(options_.sampler.sigma_max_m);
  for (const Box& box : removed_.boxes()) {
    const Box place = intersection(inflated(box, reach_m), world_->bounds_m());
    const double fit = density_per_m2_ * area_m2(place);
    const auto tries = static_cast<std::size_t>(
        std::min(kLiveTriesPerSample * fit, 10.0 * static_cast<double>(options_.samples)));
    draw_in(place, spacing_m, tries, tries, rng);
  }
  std::size_t lost = work_.samples_lost;
  for (std::size_t i = 0; i < added_.boxes().size() && lost > 0; ++i) {
    const std::size_t room = std::min(before, options_.samples);
    if (samples_.size() >= room) break;
    const std::size_t drawn = samples_.size();
    const std::size_t share = (lost + added_.boxes().size() - i - 1) / (added_.boxes().size() - i);
    draw_in(intersection(inflated(added_.boxes()[i], 2.0 * reach_m), world_->bounds_m()), 0.0,
            std::min(share, room - drawn), 20 * share, rng);
    lost -= std::min(lost, samples_.size() - drawn);
  }
  work_.samples_drawn = samples_.size() - first;
  join_samples_from(first);
}

// Draws samples in a box by rejection until `most` are found or the tries are used up. With a
// spacing, positions nearer than that to another sample are rejected (random sequential packing).
void LiveRoadmap::draw_in(const Box& box, double spacing_m, std::size_t most, std::size_t tries,
                          Rng& rng) {
  if (area_m2(box) <= 0.0) return;
  std::vector<Vec2> near_m;
  for (const Gaussian& sample : samples_) {
    if (box.distance_m(sample.mean_m()) < spacing_m) near_m.push_back(sample.mean_m());
  }
  for (std::size_t drawn = 0; drawn < most && tries > 0; --tries) {
    const Vec2 mean_m = uniform_mean(box, rng);
    const bool taken = std::any_of(near_m.begin(), near_m.end(), [&](const Vec2& other) {
      return (other - mean_m).squaredNorm() < spacing_m * spacing_m;
    });
    if (taken) continue;
    const auto sample = sample_at(mean_m, *world_, options_.risk, options_.sampler, rng);
    if (!sample) continue;
    near_m.push_back(mean_m);
    samples_.push_back(*sample);
    sigma_max_m_.push_back(sample->max_sigma_m());
    ++drawn;
  }
}

// Pairs of the new samples with all before them. Few are new, so that no search tree is built; the
// distance of means is a lower bound of W₂ and comes first.
void LiveRoadmap::join_samples_from(std::size_t first) {
  const double radius_m = options_.connection_radius_m;
  for (auto b = static_cast<std::uint32_t>(first); b < samples_.size(); ++b) {
    for (std::uint32_t a = 0; a < b; ++a) {
      const double mean_squared = (samples_[a].mean_m() - samples_[b].mean_m()).squaredNorm();
      if (mean_squared > radius_m * radius_m * (1.0 + 1e-12)) continue;
      const double distance_m = wasserstein2(samples_[a], samples_[b]);
      if (distance_m > radius_m) continue;
      sample_pairs_.push_back({{a, b, distance_m}, check(samples_[a], samples_[b])});
    }
  }
}

// Connects the terminals, keeping verdicts of terminals that were there before. Ends of a swarm in
// flight change with every plan, those of goals seldom.
void LiveRoadmap::connect_terminals(std::vector<Gaussian> terminals) {
  std::vector<Gaussian> nodes = terminals;
  nodes.insert(nodes.end(), samples_.begin(), samples_.end());
  const auto count = static_cast<std::uint32_t>(terminals.size());
  const auto old_count = static_cast<std::uint32_t>(terminals_.size());
  // The old terminal that equals each new one, if any: its verdicts are kept.
  std::vector<std::uint32_t> old_of(count, kLost);
  for (std::uint32_t t = 0; t < count; ++t) {
    const auto found = std::find_if(terminals_.begin(), terminals_.end(),
                                    [&](const Gaussian& old) { return same(old, terminals[t]); });
    if (found != terminals_.end())
      old_of[t] = static_cast<std::uint32_t>(found - terminals_.begin());
  }
  constexpr std::uint8_t kUnknown = 2;
  std::vector<std::uint8_t> known;
  std::vector<std::vector<Candidate>> next(count);
  for (std::uint32_t t = 0; t < count; ++t) {
    known.assign(old_count + samples_.size(), kUnknown);
    if (old_of[t] != kLost) {
      for (const Candidate& candidate : terminal_pairs_[old_of[t]]) {
        known[candidate.pair.b] = candidate.free ? 1 : 0;
      }
    }
    for (const NeighbourPair& pair :
         terminal_neighbours(nodes, t, count, options_.connection_radius_m)) {
      // Number of b in the old pairs of this terminal. A pair of terminals is stored with the first
      // of them: it is found only if their order is as before.
      const std::uint32_t old_b =
          pair.b >= count ? pair.b - count + old_count
          : old_of[t] != kLost && old_of[pair.b] != kLost && old_of[pair.b] > old_of[t]
              ? old_of[pair.b]
              : kLost;
      const std::uint8_t verdict = old_b == kLost ? kUnknown : known[old_b];
      const Gaussian& a = nodes[t];
      const Gaussian& b = nodes[pair.b];
      const double sigma_max_m = std::max(a.max_sigma_m(), b.max_sigma_m());
      const bool fresh = verdict == kUnknown || needs_check(a, b, sigma_max_m, verdict == 1);
      next[t].push_back({pair, fresh ? check(a, b) : verdict == 1});
    }
  }
  terminals_ = std::move(terminals);
  terminal_pairs_ = std::move(next);
}

// Assembles the free candidates; numbers of samples are shifted behind the terminals.
Roadmap LiveRoadmap::roadmap() const {
  std::vector<Gaussian> nodes = terminals_;
  nodes.insert(nodes.end(), samples_.begin(), samples_.end());
  const auto terminals = static_cast<std::uint32_t>(terminals_.size());
  std::vector<NeighbourPair> edges;
  edges.reserve(sample_pairs_.size());
  for (const std::vector<Candidate>& pairs : terminal_pairs_) {
    for (const Candidate& candidate : pairs) {
      if (candidate.free) edges.push_back(candidate.pair);
    }
  }
  for (const auto& [pair, free] : sample_pairs_) {
    if (free) edges.push_back({pair.a + terminals, pair.b + terminals, pair.distance_m});
  }
  return assemble(std::move(nodes), edges);
}

}  // namespace swarm::planner
