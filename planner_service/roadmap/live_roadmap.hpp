// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "planner_service/roadmap/edge_check.hpp"
#include "planner_service/roadmap/neighbours.hpp"
#include "planner_service/roadmap/sampler.hpp"
#include "planner_service/roadmap/world_change.hpp"
#include "swarmflow/core/box_index.hpp"
#include "swarmflow/core/gaussian.hpp"
#include "swarmflow/core/random.hpp"
#include "swarmflow/core/world.hpp"
#include "swarmflow/planning/roadmap.hpp"

namespace swarm::planner {

/// Parameters of a roadmap that is kept; those of SwarmPRM.
struct LiveRoadmapOptions {
  std::size_t samples = 500;          ///< n of Alg. 1
  double connection_radius_m = 20.0;  ///< r of Alg. 1, in W₂
  RiskLimit risk;
  SamplerOptions sampler;
  double scale = 1.0;  ///< of the tolerance of its edges, see EdgeChecker
};

/// A roadmap that is kept while the world changes, and repaired where it does.
///
/// Its edges are always those that connect() would find for its nodes in its world: an edge's
/// verdict is free when every obstacle within reach leaves it free, so that only three kinds are
/// checked again: free edges near a new obstacle, blocked ones near a removed one, and edges of new
/// nodes. All others cost a comparison of boxes.
///
/// Samples that a new obstacle invalidates are drawn again around it, and the space that a removed
/// one leaves is filled to the density the roadmap began with. The same calls and generator state
/// give the same roadmap.
class LiveRoadmap {
 public:
  /// `terminals` are the start components, then the goal components: the first nodes of the
  /// roadmap, unchanged. The caller checks whether they keep the risk limit.
  LiveRoadmap(World world, std::vector<Gaussian> terminals, const LiveRoadmapOptions& options,
              Rng& rng);

  /// Takes the present world and terminals. Finds the changes by comparing them with the last ones.
  void update(World world, std::vector<Gaussian> terminals, Rng& rng);

  const World& world() const { return *world_; }

  /// The roadmap as a copy, so that a search may close edges in it. Linear in the edges.
  Roadmap roadmap() const;

  /// Work of the last call, the constructor included.
  struct Work {
    std::size_t edges_checked = 0;
    std::size_t samples_lost = 0;
    std::size_t samples_drawn = 0;
  };
  const Work& work() const { return work_; }

 private:
  // A pair within the radius and whether its geodesic is free. Samples are numbered from 0 here, so
  // that the number of terminals does not matter.
  struct Candidate {
    NeighbourPair pair;
    bool free = false;
  };

  bool check(const Gaussian& a, const Gaussian& b);
  bool needs_check(const Gaussian& a, const Gaussian& b, double sigma_max_m, bool free) const;
  void lose_samples();
  void recheck_pairs();
  void draw_samples(std::size_t before, Rng& rng);
  void draw_in(const Box& box, double spacing_m, std::size_t most, std::size_t tries, Rng& rng);
  void join_samples_from(std::size_t first);
  void connect_terminals(std::vector<Gaussian> terminals);

  LiveRoadmapOptions options_;
  double k_ = 0.0;
  std::unique_ptr<const World> world_;  // the checker's, wherever this object moves
  EdgeChecker checker_;
  double density_per_m2_ = 0.0;
  std::vector<Gaussian> terminals_;
  std::vector<Gaussian> samples_;
  std::vector<double> sigma_max_m_;  // of the samples
  std::vector<Candidate> sample_pairs_;
  // Of each terminal: b counts terminals first, then samples.
  std::vector<std::vector<Candidate>> terminal_pairs_;
  BoxIndex added_;
  BoxIndex removed_;
  Work work_;
};

}  // namespace swarm::planner
