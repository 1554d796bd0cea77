// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm {

/// One Gaussian the swarm flows through: g with mass w, reached at `time`.
struct PlanNode {
  Gaussian gaussian;    ///< g, world frame
  MissionTime time{0};  ///< plan time τ at which the mass is distributed as g [s]
  double mass = 0.0;    ///< w: share of the swarm that passes the node, in (0, 1]
};

/// Mass that moves along the W₂ geodesic [SwarmPRM, eq. 3–4] from one node to a later one.
struct PlanLeg {
  std::uint32_t from = 0;  ///< index into FlowPlan::nodes()
  std::uint32_t to = 0;    ///< index into FlowPlan::nodes(), of a node with a later time
  double mass = 0.0;       ///< π(from, to): share of the swarm that takes it, in (0, 1]
};

/// A flow of Gaussians: the plan, in the same form in solvers, messages, files and robots. It is a
/// directed acyclic graph whose legs run forward in time; the mass into a node equals the mass out
/// of it, except at sources (no leg in; together mass 1) and sinks (no leg out; together mass 1).
/// SwarmPRM's routes ξᵢⱼ with mass λᵢⱼ [eq. 13], ROVER's π_k(i, j) [eq. 11] and a CRoPS guide path
/// are all such flows.
///
/// Immutable once made, apart from assignment; const functions may run in several threads at once.
class FlowPlan {
 public:
  static constexpr std::size_t kMaxNodes = 4096;  ///< most nodes that a plan message holds
  static constexpr std::size_t kMaxLegs = 8192;   ///< most legs that a plan message holds
  /// Absolute tolerance of every check of masses in make().
  static constexpr double kMassTolerance = 1e-6;

  /// An empty plan: no nodes, duration 0. Only empty() and the plain accessors may be called.
  FlowPlan() = default;

  /// Checks and indexes a flow in O(nodes + legs). A node may be source and sink at once (mass that
  /// stays where it is).
  /// \return kBadInput, with the offending node or leg in the message: no nodes, sizes over the
  ///   bounds, indices out of range, times that are not finite, legs that do not run forward in
  ///   time, masses outside (0, 1], sources or sinks that do not sum to 1, nodes that gain or lose
  ///   mass
  static Result<FlowPlan> make(std::vector<PlanNode> nodes, std::vector<PlanLeg> legs);

  /// All nodes, in the order given to make(). Sources, sinks and legs refer to them by index.
  const std::vector<PlanNode>& nodes() const { return nodes_; }
  /// All legs, in the order given to make().
  const std::vector<PlanLeg>& legs() const { return legs_; }
  /// Nodes without a leg in, as ascending indices into nodes(): one for each start component.
  const std::vector<std::uint32_t>& sources() const { return sources_; }
  /// Nodes without a leg out, as ascending indices into nodes(): one for each goal component in
  /// use.
  const std::vector<std::uint32_t>& sinks() const { return sinks_; }

  /// Legs that leave a node, as ascending indices into legs(); empty for a sink. Valid while the
  /// plan exists. \pre node < nodes().size(), asserted
  std::span<const std::uint32_t> legs_out(std::uint32_t node) const;

  /// Plan time at which the last mass arrives: the largest node time, at least 0 [s].
  MissionTime duration() const { return duration_; }

  /// The mixture χ(t) that the swarm is to form at plan time t [SwarmPRM, eq. 1]:
  ///
  ///   χ(t) = Σ π(leg) · ĝ_leg((t − t_from)/(t_to − t_from))
  ///
  /// over the legs with t_from ≤ t < t_to; ĝ is the W₂ geodesic. Sources count as at rest before
  /// their time, sinks from their time on. Weights sum to 1 at every t. O(nodes + legs), allocates.
  /// \pre !empty(), asserted
  Mixture mixture_at(MissionTime t) const;

  /// FNV-1a hash of nodes and legs, the same on every machine: equal digests mean the same flow,
  /// also if it was published by another planner under another version. 0 for an empty plan. Not
  /// cryptographic.
  std::uint64_t digest() const { return digest_; }

  /// Whether the plan has no nodes, as after default construction.
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
