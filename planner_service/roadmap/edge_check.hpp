// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "swarm_core/gmm/wasserstein.hpp"
#include "swarmflow/core/cvar.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::planner {

/// An end of edges, with values that every edge of it needs. The distances to obstacles cached here
/// hold for one world and one risk limit.
class EdgeEnd {
 public:
  explicit EdgeEnd(const Gaussian& g)
      : gaussian_(g), sigma_min_m_(g.min_sigma_m()), sigma_max_m_(g.max_sigma_m()) {
    seen_obstacle_.fill(kNothing);
  }

  const Gaussian& gaussian() const { return gaussian_; }
  const Vec2& mean_m() const { return gaussian_.mean_m(); }
  double sigma_min_m() const { return sigma_min_m_; }
  double sigma_max_m() const { return sigma_max_m_; }

 private:
  friend class EdgeChecker;
  static constexpr std::uint32_t kNothing = ~0U;
  static constexpr std::size_t kSeen = 8;
  // Slack, distance and facing edge of one obstacle, as seen from the mean.
  struct Seen {
    double slack_m;
    double distance_m;
    int face;
  };

  Gaussian gaussian_;
  double sigma_min_m_;
  double sigma_max_m_;
  // A direct-mapped cache by the last bits of an obstacle's index. Entries of seen_ without an
  // obstacle are not set.
  std::array<std::uint32_t, kSeen> seen_obstacle_;
  std::array<Seen, kSeen> seen_;
};

/// COLLISIONFREE of SwarmPRM, Alg. 1: whether every Gaussian on the W₂ geodesic keeps CVaR ≤ δ.
///
/// Proven between the samples, obstacle by obstacle. Where both ends of an interval face the same
/// edge of an obstacle, CVaR = −s(t) + k|Σ_a^½((1−t)I + tT)n| is linear plus the norm of something
/// linear: convex, so the ends bound it. Elsewhere the interval is halved until its ends prove it:
/// the slack δ − CVaR changes along the edge at most by
///
///   L = |Δμ| + k √(W₂² − |Δμ|²) + k (σ_max − σ_min) |Δμ| / s
///
/// (path of the mean, change of shape, turn of the normal at distance s from a corner), so slacks a
/// and b at the ends of an interval of length h prove that CVaR ≤ δ + tolerance on it when a + b +
/// 2 · tolerance ≥ L h.
///
/// Keeps scratch memory: one checker per thread.
class EdgeChecker {
 public:
  /// A hundred times what any edge of a plan in metres needs.
  static constexpr std::size_t kMostIntervals = 1U << 14U;

  /// Keeps a reference to the world. Tolerances are those of default bodies: `scale` is the factor
  /// on them for others (body_scale.hpp).
  EdgeChecker(const World& world, const RiskLimit& risk, double scale = 1.0);

  /// True proves CVaR ≤ δ + tolerance on the whole edge; false means a point with CVaR > δ, or that
  /// kMostIntervals did not prove it: cost grows with 1/tolerance where the edge runs along the
  /// limit, and without bound with the numbers of a Gaussian kilometres long and millimetres wide.
  bool is_free(EdgeEnd& a, EdgeEnd& b, double tolerance_m);
  bool is_free(const Gaussian& a, const Gaussian& b, double tolerance_m) {
    EdgeEnd from(a);
    EdgeEnd to(b);
    return is_free(from, to, tolerance_m);
  }

  /// Distance from the box of the means' path, or from one mean, up to which an obstacle can
  /// matter, when σ_max is the widest of the ends [m].
  double reach_m(double sigma_max_m) const { return k_ * sigma_max_m - delta_m_; }

  /// Takes another world from now on; keeps a reference to it.
  void set_world(const World& world) { world_ = &world; }

 private:
  // The slack δ − CVaR against one obstacle at one point of the edge.
  struct Sample {
    double t = 0.0;
    double slack_m = 0.0;
    double distance_m = 0.0;
    int face = ConvexObstacle::kNoFace;
  };
  // A part of the edge that is not proven yet against one obstacle.
  struct Interval {
    const ConvexObstacle* obstacle = nullptr;
    Sample from, to;
  };

  /// The geodesic as polynomials of t, so that a sample costs a few products and no matrix:
  /// Σ(t) = (1−t)²Σ_a + t(1−t)(TΣ_a + Σ_aT) + t²Σ_b.
  struct Sweep {
    Sweep(const Gaussian& a, const Gaussian& b);
    Vec2 from_m, step_m;
    std::array<double, 3> xx{}, xy{}, yy{};  // coefficients of the three products of t
  };

  /// How fast the slack may change over the whole edge.
  struct Rates {
    Rates(const EdgeEnd& a, const EdgeEnd& b, double k, double delta_m);
    double straight_m;
    double turn_m2;  // to be divided by the distance of the corner
    double mean_path_m;
    double distance_min_m;  // of the mean, where the limit holds: s ≥ kσ_min − δ
  };

  Sample sample(const ConvexObstacle& obstacle, const Sweep& sweep, double t) const;
  const EdgeEnd::Seen& look(EdgeEnd& end, std::uint32_t obstacle) const;
  static bool faces_one_edge(const Interval& interval) {
    return interval.from.face == interval.to.face && interval.from.face != ConvexObstacle::kNoFace;
  }
  static bool is_proven(const Interval& interval, const Rates& rates, double tolerance_m);

  const World* world_;
  double k_;
  double delta_m_;
  double scale_;
  std::vector<Interval> open_;
};

}  // namespace swarm::planner
