// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "swarmflow/core/time.hpp"
#include "swarmflow/core/mixture.hpp"

namespace swarm {

/// One Gaussian the swarm flows through: g with mass w, reached at `time`.
struct PlanNode {
  Gaussian gaussian;
  MissionTime time{0};
  double mass = 0.0;  ///< share of the swarm, in (0, 1]
};

/// Mass that moves along the W₂ geodesic from one node to a later one.
struct PlanLeg {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  double mass = 0.0;  ///< π(from, to) in (0, 1]
};

/// The flow of Gaussians: the one notion from solver over wire to robot. A directed acyclic graph
/// whose legs run forward in time; the mass into a node equals the mass out of it, except at
/// sources (no leg in; together mass 1) and sinks (no leg out; together mass 1). SwarmPRM's routes
/// ξᵢⱼ with mass λᵢⱼ, ROVER's π_k(i,j) and a CRoPS guide path are all such flows.
class FlowPlan {
 public:
  static constexpr std::size_t kMaxNodes = 4096;  ///< bound of the wire format
  static constexpr std::size_t kMaxLegs = 8192;   ///< bound of the wire format
  static constexpr double kMassTolerance = 1e-6;

  FlowPlan() = default;

  /// Refuses: sizes over the bounds, bad indices, non-finite or decreasing times, masses outside
  /// (0, 1], sources or sinks that do not sum to 1, nodes that gain or lose mass.
  static Result<FlowPlan> make(std::vector<PlanNode> nodes, std::vector<PlanLeg> legs);

  const std::vector<PlanNode>& nodes() const { return nodes_; }
  const std::vector<PlanLeg>& legs() const { return legs_; }
  const std::vector<std::uint32_t>& sources() const { return sources_; }
  const std::vector<std::uint32_t>& sinks() const { return sinks_; }

  /// Legs that leave a node (indices into legs()), in order of their index.
  std::span<const std::uint32_t> legs_out(std::uint32_t node) const;

  /// Time at which the last mass arrives.
  MissionTime duration() const { return duration_; }

  /// mixture(t) = Σ over the legs alive at t of π · geodesic((t−t_from)/(t_to−t_from)). Before
  /// their time sources stand still, after it sinks do. The weights sum to 1 at every t.
  Mixture mixture_at(MissionTime t) const;

  /// Hash of the content: two plans with the same digest are the same flow, whoever published them.
  std::uint64_t digest() const { return digest_; }

  bool empty() const { return nodes_.empty(); }

 private:
  std::vector<PlanNode> nodes_;
  std::vector<PlanLeg> legs_;
  std::vector<std::uint32_t> sources_, sinks_;
  std::vector<std::uint32_t> out_offset_, out_legs_;  // legs grouped by `from`
  MissionTime duration_{0};
  std::uint64_t digest_ = 0;
};

}  // namespace swarm
