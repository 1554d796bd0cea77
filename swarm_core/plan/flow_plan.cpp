// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/flow_plan.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/base/assert.hpp"
#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm {
namespace {

bool is_mass(double mass) {
  // The tolerance allows a single source whose mass is 1 plus the rounding of a sum.
  return std::isfinite(mass) && mass > 0.0 && mass <= 1.0 + FlowPlan::kMassTolerance;
}

bool differ(double a, double b) { return std::abs(a - b) > FlowPlan::kMassTolerance; }

// FNV-1a, 64 bit, over the numbers' bytes from low to high: the same on every machine.
class Digest {
 public:
  void add(std::uint64_t value) {
    for (unsigned shift = 0; shift < 64; shift += 8) {
      hash_ = (hash_ ^ ((value >> shift) & 0xFFU)) * 0x100000001B3ULL;
    }
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value + 0.0)); }  // −0 counts as 0
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xCBF29CE484222325ULL;
};

// The number of nodes is hashed too, so that a node cannot be taken for a leg. Of the symmetric
// covariance three entries suffice.
std::uint64_t digest_of(const std::vector<PlanNode>& nodes, const std::vector<PlanLeg>& legs) {
  Digest digest;
  digest.add(std::uint64_t{nodes.size()});
  for (const PlanNode& node : nodes) {
    const Vec2& mean = node.gaussian.mean_m();
    const Mat2& covariance = node.gaussian.covariance_m2();
    for (const double value : {mean.x(), mean.y(), covariance(0, 0), covariance(0, 1),
                               covariance(1, 1), node.time.count(), node.mass}) {
      digest.add(value);
    }
  }
  for (const PlanLeg& leg : legs) {
    digest.add(std::uint64_t{leg.from});
    digest.add(std::uint64_t{leg.to});
    digest.add(leg.mass);
  }
  return digest.value();
}

// What can be checked for each node and leg by itself. Legs that run forward in time exclude
// cycles, so no graph search is needed.
Result<void> check_parts(const std::vector<PlanNode>& nodes, const std::vector<PlanLeg>& legs) {
  if (nodes.empty()) return fail(ErrorCode::kBadInput, "plan: has no nodes");
  if (nodes.size() > FlowPlan::kMaxNodes || legs.size() > FlowPlan::kMaxLegs) {
    return fail(ErrorCode::kBadInput,
                fmt::format("plan: {} nodes and {} legs, at most {} and {} fit a message",
                            nodes.size(), legs.size(), FlowPlan::kMaxNodes, FlowPlan::kMaxLegs));
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!std::isfinite(nodes[i].time.count())) {
      return fail(ErrorCode::kBadInput, fmt::format("plan: time of node {} is not finite", i));
    }
    if (!is_mass(nodes[i].mass)) {
      return fail(ErrorCode::kBadInput,
                  fmt::format("plan: mass {} of node {} is not in (0, 1]", nodes[i].mass, i));
    }
  }
  for (std::size_t i = 0; i < legs.size(); ++i) {
    const PlanLeg& leg = legs[i];
    if (leg.from >= nodes.size() || leg.to >= nodes.size()) {
      return fail(ErrorCode::kBadInput,
                  fmt::format("plan: leg {} runs from node {} to node {} of {}", i, leg.from,
                              leg.to, nodes.size()));
    }
    if (!(nodes[leg.from].time < nodes[leg.to].time)) {
      return fail(ErrorCode::kBadInput,
                  fmt::format("plan: leg {} does not run forward in time, from {} s to {} s", i,
                              nodes[leg.from].time.count(), nodes[leg.to].time.count()));
    }
    if (!is_mass(leg.mass)) {
      return fail(ErrorCode::kBadInput,
                  fmt::format("plan: mass {} of leg {} is not in (0, 1]", leg.mass, i));
    }
  }
  return {};
}

}  // namespace

// Conservation of mass is checked per node, within kMassTolerance; then the legs are grouped by
// their first node in a counting sort (CSR), O(nodes + legs).
Result<FlowPlan> FlowPlan::make(std::vector<PlanNode> nodes, std::vector<PlanLeg> legs) {
  if (auto checked = check_parts(nodes, legs); !checked) return tl::unexpected(checked.error());

  FlowPlan plan;
  std::vector<double> mass_in(nodes.size(), 0.0);
  std::vector<double> mass_out(nodes.size(), 0.0);
  plan.out_offset_.assign(nodes.size() + 1, 0);
  for (const PlanLeg& leg : legs) {
    mass_out[leg.from] += leg.mass;
    mass_in[leg.to] += leg.mass;
    ++plan.out_offset_[leg.from + 1];
  }
  double source_mass = 0.0;
  double sink_mass = 0.0;
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    const double mass = nodes[i].mass;
    // Masses of legs are positive, so a sum of 0 means no legs.
    if (mass_in[i] == 0.0) {
      plan.sources_.push_back(i);
      source_mass += mass;
    } else if (differ(mass_in[i], mass)) {
      return fail(ErrorCode::kBadInput,
                  fmt::format("plan: node {} has mass {}, but {} comes in", i, mass, mass_in[i]));
    }
    if (mass_out[i] == 0.0) {
      plan.sinks_.push_back(i);
      sink_mass += mass;
    } else if (differ(mass_out[i], mass)) {
      return fail(ErrorCode::kBadInput,
                  fmt::format("plan: node {} has mass {}, but {} goes out", i, mass, mass_out[i]));
    }
    plan.duration_ = std::max(plan.duration_, nodes[i].time);
  }
  if (differ(source_mass, 1.0) || differ(sink_mass, 1.0)) {
    return fail(ErrorCode::kBadInput,
                fmt::format("plan: sources sum to {} and sinks to {}, both must be 1", source_mass,
                            sink_mass));
  }

  for (std::size_t i = 0; i < nodes.size(); ++i) plan.out_offset_[i + 1] += plan.out_offset_[i];
  // `out_offset_[i]` is where the legs of node i begin; `fill` advances as they are entered.
  plan.out_legs_.resize(legs.size());
  std::vector<std::uint32_t> fill(plan.out_offset_.begin(), plan.out_offset_.end() - 1);
  for (std::uint32_t i = 0; i < legs.size(); ++i) plan.out_legs_[fill[legs[i].from]++] = i;

  plan.digest_ = digest_of(nodes, legs);
  plan.nodes_ = std::move(nodes);
  plan.legs_ = std::move(legs);
  return plan;
}

std::span<const std::uint32_t> FlowPlan::legs_out(std::uint32_t node) const {
  SWARM_ASSERT(node < nodes_.size());
  return std::span(out_legs_).subspan(out_offset_[node], out_offset_[node + 1] - out_offset_[node]);
}

// [SwarmPRM, eq. 1]. Half-open intervals count each mass once at the time of a node: it is on the
// outgoing leg from then on.
Mixture FlowPlan::mixture_at(MissionTime t) const {
  SWARM_ASSERT(!empty());
  std::vector<WeightedGaussian> components;
  for (const std::uint32_t i : sources_) {
    if (t < nodes_[i].time) components.push_back({nodes_[i].mass, nodes_[i].gaussian});
  }
  for (const PlanLeg& leg : legs_) {
    const PlanNode& from = nodes_[leg.from];
    const PlanNode& to = nodes_[leg.to];
    if (t < from.time || t >= to.time) continue;
    const double share = (t - from.time) / (to.time - from.time);
    components.push_back({leg.mass, Geodesic(from.gaussian, to.gaussian).at(share)});
  }
  for (const std::uint32_t i : sinks_) {
    if (t >= nodes_[i].time) components.push_back({nodes_[i].mass, nodes_[i].gaussian});
  }
  // Each node keeps its mass within the tolerance; over a long chain the sum may leave the
  // mixture's own tolerance, so it is normalised here.
  double sum = 0.0;
  for (const WeightedGaussian& component : components) sum += component.weight;
  for (WeightedGaussian& component : components) component.weight /= sum;
  Result<Mixture> mixture = Mixture::make(std::move(components));
  SWARM_ASSERT(mixture.has_value());
  return *std::move(mixture);
}

}  // namespace swarm
