// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/disc_density.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <unordered_map>
#include <vector>

#include "swarmflow/core/box.hpp"

namespace swarm::monitor {
namespace {

/// Area of a disc; width at which a Gaussian is cut off (4σ hold 99.97 % of a 2-D Gaussian); limits
/// on the spacing of the grid.
constexpr double kDiscArea_m2 = std::numbers::pi * kDiscRadius_m * kDiscRadius_m;
constexpr double kCutSigmas = 4.0;
constexpr double kCoarsest_m = 1.0, kFinest_m = 0.25;
/// Number of cells of one grid. A mixture that spreads wider than this at the wanted spacing gets a
/// coarser grid, which bounds time and memory (32 MB).
constexpr double kMostCells = 4e6;

/// A hash grid of points: the neighbours of a point lie in its cell and the eight around it, so a
/// search does not look at all points.
class Buckets {
 public:
  Buckets(std::span<const Vec2> points, double size_m) : points_(points), size_m_(size_m) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      buckets_[key(cell(points[i].x()), cell(points[i].y()))].push_back(i);
    }
  }
  /// Calls look(j) for all points within one cell size of a point, and for some that are farther.
  template <class Look>
  void near(const Vec2& p, Look look) const {
    const std::int32_t x = cell(p.x()), y = cell(p.y());
    for (std::int32_t i = x - 1; i <= x + 1; ++i) {
      for (std::int32_t j = y - 1; j <= y + 1; ++j) {
        const auto bucket = buckets_.find(key(i, j));
        if (bucket == buckets_.end()) continue;
        for (const std::size_t k : bucket->second) look(k);
      }
    }
  }

 private:
  std::int32_t cell(double x) const {
    const double c = std::floor(x / size_m_);
    return c > -1e9 && c < 1e9 ? static_cast<std::int32_t>(c) : 0;  // a log may be damaged
  }
  // Both coordinates in one 64-bit key.
  static std::uint64_t key(std::int32_t x, std::int32_t y) {
    return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32U) |
           static_cast<std::uint32_t>(y);
  }

  std::span<const Vec2> points_;
  double size_m_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> buckets_;
};

/// Densities at the points of a regular grid, row by row.
struct Grid {
  Box box;
  double spacing_m;
  std::int64_t columns, rows;
  std::vector<double> density{};

  double& at(std::int64_t x, std::int64_t y) {
    return density[static_cast<std::size_t>(y * columns + x)];
  }
};

/// Standard deviations along x and y. They bound the ellipse of a rotated Gaussian, too.
Vec2 sigmas_m(const Gaussian& gaussian) {
  const Mat2& c = gaussian.covariance_m2();
  return {std::sqrt(c(0, 0)), std::sqrt(c(1, 1))};
}

/// A grid around all components with a margin of one disc, so that every disc around a grid point
/// with density lies inside. The spacing follows the smallest σ, which the grid must resolve.
Grid grid_for(const Mixture& mixture) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Box box{Vec2::Constant(kInfinity), Vec2::Constant(-kInfinity)};
  double spacing_m = kCoarsest_m;
  for (const auto& [weight, gaussian] : mixture.components()) {
    const Vec2 reach = kCutSigmas * sigmas_m(gaussian) + Vec2::Constant(kDiscRadius_m);
    box.min_m = box.min_m.cwiseMin(gaussian.mean_m() - reach);
    box.max_m = box.max_m.cwiseMax(gaussian.mean_m() + reach);
    spacing_m = std::min(spacing_m, gaussian.min_sigma_m());
  }
  const Vec2 size = box.max_m - box.min_m;
  spacing_m = std::max({spacing_m, kFinest_m, std::sqrt(size.x() * size.y() / kMostCells)});
  Grid grid{.box = box,
            .spacing_m = spacing_m,
            .columns = static_cast<std::int64_t>(std::ceil(size.x() / spacing_m)) + 1,
            .rows = static_cast<std::int64_t>(std::ceil(size.y() / spacing_m)) + 1};
  grid.density.assign(static_cast<std::size_t>(grid.columns * grid.rows), 0.0);
  return grid;
}

/// Adds the weighted density of one component at the grid points within 4σ of its mean.
void add_component(const WeightedGaussian& component, Grid& grid) {
  const auto& [weight, gaussian] = component;
  const Vec2 reach = kCutSigmas * sigmas_m(gaussian);
  const auto cells = [&](double from, double to, double begin, std::int64_t count) {
    const auto first = static_cast<std::int64_t>(std::ceil((from - begin) / grid.spacing_m));
    const auto last = static_cast<std::int64_t>(std::floor((to - begin) / grid.spacing_m));
    return std::pair(std::max<std::int64_t>(first, 0), std::min(last, count - 1));
  };
  const Vec2 low = gaussian.mean_m() - reach, high = gaussian.mean_m() + reach;
  const auto [x0, x1] = cells(low.x(), high.x(), grid.box.min_m.x(), grid.columns);
  const auto [y0, y1] = cells(low.y(), high.y(), grid.box.min_m.y(), grid.rows);
  for (std::int64_t y = y0; y <= y1; ++y) {
    for (std::int64_t x = x0; x <= x1; ++x) {
      const Vec2 at =
          grid.box.min_m + grid.spacing_m * Vec2(static_cast<double>(x), static_cast<double>(y));
      grid.at(x, y) += weight * gaussian.density(at);
    }
  }
}

/// A cell of the disc: its offset in the grid, and the share of its area that lies in the disc.
struct Part {
  std::int64_t x, y;
  double share;
};

/// The cells that a disc around a grid point covers, each with its covered share by 20 × 20 sample
/// points: weighting the cells at the rim is what makes a coarse grid accurate.
std::vector<Part> disc_of(double spacing_m) {
  constexpr int kFine = 20;
  const auto reach = static_cast<std::int64_t>(std::ceil(kDiscRadius_m / spacing_m + 0.5));
  std::vector<Part> parts;
  for (std::int64_t y = -reach; y <= reach; ++y) {
    for (std::int64_t x = -reach; x <= reach; ++x) {
      int inside = 0;
      for (int i = 0; i < kFine; ++i) {
        for (int j = 0; j < kFine; ++j) {
          const Vec2 p(static_cast<double>(x) + (i + 0.5) / kFine - 0.5,
                       static_cast<double>(y) + (j + 0.5) / kFine - 0.5);
          inside += (spacing_m * p).norm() <= kDiscRadius_m ? 1 : 0;
        }
      }
      if (inside > 0) parts.push_back({x, y, inside / static_cast<double>(kFine * kFine)});
    }
  }
  return parts;
}

}  // namespace

/// Angular sweep. For each point i, the centres of discs with i on the rim lie on a circle around
/// i; each other point j within two radii is inside for an arc of that circle. The largest number
/// of arcs over one angle, plus the points at i itself, is the answer for i.
std::size_t most_in_a_disc(std::span<const Vec2> points, double radius_m) {
  if (points.empty()) return 0;
  const Buckets buckets(points, 2.0 * radius_m);
  std::size_t most = 1;
  std::vector<std::pair<double, int>> turns;  // angle of the centre, +1 in, −1 out
  for (std::size_t i = 0; i < points.size(); ++i) {
    turns.clear();
    std::size_t always = 1;  // point i itself and those at its position
    std::size_t at_begin = 0;
    buckets.near(points[i], [&](std::size_t j) {
      if (j == i) return;
      const Vec2 d = points[j] - points[i];
      const double distance_m = d.norm();
      if (!(distance_m <= 2.0 * radius_m)) return;
      if (distance_m == 0.0) {
        ++always;
        return;
      }
      // Centres at distance r from point i whose disc holds point j: the arc of half-angle
      // acos(d/2r) around the direction of j.
      const double half = std::acos(std::min(1.0, distance_m / (2.0 * radius_m)));
      const double middle = std::atan2(d.y(), d.x());
      double in = middle - half, out = middle + half;
      const auto wrapped = [](double a) {
        if (a < -std::numbers::pi) return a + 2.0 * std::numbers::pi;
        return a > std::numbers::pi ? a - 2.0 * std::numbers::pi : a;
      };
      in = wrapped(in);
      out = wrapped(out);
      // An arc that crosses ±π is open at the begin of the sweep.
      if (in > out) ++at_begin;
      turns.emplace_back(in, 1);
      turns.emplace_back(out, -1);
    });
    // Even if all arcs overlapped, this point could not improve on the best so far.
    if (always + turns.size() / 2 <= most) continue;
    // At equal angles both points lie on the rim of the same disc, so the entering one is counted
    // before the leaving one.
    std::sort(turns.begin(), turns.end(), [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first < b.first : a.second > b.second;
    });
    std::size_t inside = always + at_begin;
    most = std::max(most, inside);
    for (const auto& [angle, turn] : turns) {
      inside = turn > 0 ? inside + 1 : inside - 1;
      most = std::max(most, inside);
    }
  }
  return most;
}

/// Points per area of the fullest disc.
double peak_density_per_m2(std::span<const Vec2> points) {
  return static_cast<double>(most_in_a_disc(points, kDiscRadius_m)) / kDiscArea_m2;
}

/// Sum over a disc = Σ cells share · density · cell area, for the discs around all grid points; the
/// mean over the disc's area, times the number of robots.
double planned_peak_density_per_m2(const Mixture& mixture, std::size_t robots) {
  Grid grid = grid_for(mixture);
  for (const WeightedGaussian& component : mixture.components()) add_component(component, grid);
  const std::vector<Part> disc = disc_of(grid.spacing_m);
  const auto reach = static_cast<std::int64_t>(std::ceil(kDiscRadius_m / grid.spacing_m + 0.5));
  double most = 0.0;
  for (std::int64_t y = reach; y < grid.rows - reach; ++y) {
    for (std::int64_t x = reach; x < grid.columns - reach; ++x) {
      if (grid.at(x, y) == 0.0) continue;
      double sum = 0.0;
      for (const Part& part : disc) sum += part.share * grid.at(x + part.x, y + part.y);
      most = std::max(most, sum);
    }
  }
  const double cell_m2 = grid.spacing_m * grid.spacing_m;
  return static_cast<double>(robots) * most * cell_m2 / kDiscArea_m2;
}

}  // namespace swarm::monitor
