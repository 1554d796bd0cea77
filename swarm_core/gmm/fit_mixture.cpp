// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/gmm/fit_mixture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

namespace swarm {
namespace {

// Of one mixture: a robot log stores the goal component in one byte, and 255 means none.
constexpr std::uint32_t kMaxComponents = 255;
// The search for the number of components ends after this many numbers without a better BIC.
constexpr std::uint32_t kBicStepsWithoutGain = 3;
// EM iterations that each start is given before the best start is chosen.
constexpr std::uint32_t kFirstSteps = 10;
// A component with less than this share of the weight has no meaningful covariance.
constexpr double kNothing = 1e-12;
// A share below e⁻⁴⁰ is lost in the rounding of the others' sum.
constexpr double kNoShare = -40.0;

// One Gaussian of the fit, without the checks of swarm::Gaussian.
struct Component {
  double weight = 0.0;
  Vec2 mean_m = Vec2::Zero();
  Mat2 covariance_m2 = Mat2::Zero();
};

// The result of one run of EM: its components and F after each iteration.
struct Climb {
  std::vector<Component> components;
  std::vector<double> history;  // of F
};

// ln ω + E[ln g] as a quadratic form, ready for a sweep over the patches.
struct LogDensity {
  explicit LogDensity(const Component& component) : mean_m(component.mean_m) {
    const Mat2& s = component.covariance_m2;
    const double determinant = s(0, 0) * s(1, 1) - s(0, 1) * s(0, 1);
    xx = 0.5 * s(1, 1) / determinant;
    xy = -s(0, 1) / determinant;  // counts for both off-diagonals
    yy = 0.5 * s(0, 0) / determinant;
    constant =
        std::log(component.weight) - 0.5 * std::log(determinant) - std::log(2.0 * std::numbers::pi);
  }
  // ln ω + ln g(c) − ½ tr(Σ⁻¹ S) of a patch with centre c and spread S.
  double of(const Patch& patch) const {
    const double dx = patch.center_m.x() - mean_m.x();
    const double dy = patch.center_m.y() - mean_m.y();
    const Mat2& spread = patch.spread_m2;
    return constant - xx * (dx * dx + spread(0, 0)) - xy * (dx * dy + spread(0, 1)) -
           yy * (dy * dy + spread(1, 1));
  }
  Vec2 mean_m;
  double xx, xy, yy, constant;
};

// Raises the eigenvalues below `floor_m2` to it and keeps the eigenvectors. A symmetric 2×2 matrix
// has the eigenvalues middle ± radius, so no eigen-decomposition is needed.
Mat2 raised_to_floor(const Mat2& s, double floor_m2) {
  const double middle = 0.5 * (s(0, 0) + s(1, 1));
  const double half_difference = 0.5 * (s(0, 0) - s(1, 1));
  const double radius = std::hypot(half_difference, s(0, 1));
  if (middle - radius >= floor_m2) return s;
  const double large = std::max(middle + radius, floor_m2);
  const double small = std::max(middle - radius, floor_m2);
  Mat2 raised = 0.5 * (large + small) * Mat2::Identity();
  if (radius > 0.0) {
    Mat2 direction;
    direction << half_difference, s(0, 1), s(0, 1), -half_difference;
    raised += 0.5 * (large - small) / radius * direction;
  }
  return raised;
}

// Weighted moments of patches about a reference point, from which the M-step computes a component.
struct Sums {
  double weight = 0.0;
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;

  void add(double mass, const Patch& patch, const Vec2& about_m) {
    const double dx = patch.center_m.x() - about_m.x();
    const double dy = patch.center_m.y() - about_m.y();
    weight += mass;
    x += mass * dx;
    y += mass * dy;
    xx += mass * (dx * dx + patch.spread_m2(0, 0));
    xy += mass * (dx * dy + patch.spread_m2(0, 1));
    yy += mass * (dy * dy + patch.spread_m2(1, 1));
  }

  // Mean and covariance by the shift of moments: Σ = E[dd'] − step·step', d the offset from
  // `about_m`.
  Component component(const Vec2& about_m, double sigma_min_m) const {
    const Vec2 step(x / weight, y / weight);
    Mat2 covariance;
    covariance << xx, xy, xy, yy;
    covariance = covariance / weight - step * step.transpose();
    return {weight, about_m + step, raised_to_floor(covariance, sigma_min_m * sigma_min_m)};
  }
};

// Expectation-maximisation on one set of patches. `components_` and `shares_` are the state that
// the two steps exchange; every step costs O(patches · components).
class Fitter {
 public:
  Fitter(std::vector<Patch> patches, const FitOptions& options)
      : patches_(std::move(patches)), options_(options) {}

  // Runs a few EM iterations from each start, then continues from the start with the largest F.
  Climb best_of_starts(std::uint32_t components, Rng& rng) {
    Climb best;
    for (std::uint32_t start = 0; start < options_.starts; ++start) {
      share_by_nearest(spread_centres(components, rng));
      Climb climbed = climb(std::min(kFirstSteps, options_.iterations_max));
      if (best.history.empty() || climbed.history.back() > best.history.back()) {
        best = std::move(climbed);
      }
    }
    return climb_from(std::move(best.components));
  }

  // Removes components lighter than weight_min and runs EM again without them, until no component
  // is too light. The heaviest component always stays.
  void drop_light(Climb& climb_so_far) {
    for (std::uint32_t round = 0; round < kMaxComponents; ++round) {
      std::vector<Component>& components = climb_so_far.components;
      const auto heaviest =
          std::max_element(components.begin(), components.end(),
                           [](const auto& a, const auto& b) { return a.weight < b.weight; });
      const double least = std::min(options_.weight_min, heaviest->weight);
      if (std::erase_if(components, [&](const auto& c) { return c.weight < least; }) == 0) return;
      double sum = 0.0;
      for (const Component& component : components) sum += component.weight;
      for (Component& component : components) component.weight /= sum;
      climb_so_far = climb_from(std::move(components));
    }
  }

  // BIC = −2nF + (6K − 1) ln n. The patches are weighted, so n is their effective number (Σv)²/Σv²
  // (Kish) with Σv = 1; a component has a weight, 2 coordinates and 3 covariances, less one for Σω
  // = 1.
  double bic(const Climb& climbed) const {
    double squares = 0.0;
    for (const Patch& patch : patches_) squares += patch.weight * patch.weight;
    const double n = 1.0 / squares;
    const double parameters = 6.0 * static_cast<double>(climbed.components.size()) - 1.0;
    return -2.0 * n * climbed.history.back() + parameters * std::log(n);
  }

 private:
  // k-means++: each centre with a chance that grows with the square of its distance to the others.
  std::vector<Vec2> spread_centres(std::uint32_t components, Rng& rng) const {
    std::vector<Vec2> centres;
    std::vector<double> chance(patches_.size());
    for (std::size_t i = 0; i < patches_.size(); ++i) chance[i] = patches_[i].weight;
    std::vector<double> nearest_m2(patches_.size(), std::numeric_limits<double>::infinity());
    while (centres.size() < components) {
      const auto chosen = draw(chance, rng);
      if (!chosen) break;  // every patch is a centre already
      centres.push_back(patches_[*chosen].center_m);
      for (std::size_t i = 0; i < patches_.size(); ++i) {
        const double squared_m2 = (patches_[i].center_m - centres.back()).squaredNorm();
        nearest_m2[i] = std::min(nearest_m2[i], squared_m2);
        chance[i] = patches_[i].weight * nearest_m2[i];
      }
    }
    return centres;
  }

  // Inverse-transform sampling of an index in proportion to `chance`; empty if every chance is 0.
  // `last` catches a rounding of the sum that leaves `left` above 0 after the last index.
  static std::optional<std::size_t> draw(const std::vector<double>& chance, Rng& rng) {
    double sum = 0.0;
    for (const double c : chance) sum += c;
    if (!(sum > 0.0)) return std::nullopt;
    double left = sum * uniform01(rng);
    std::optional<std::size_t> last;
    for (std::size_t i = 0; i < chance.size(); ++i) {
      if (chance[i] <= 0.0) continue;
      last = i;
      left -= chance[i];
      if (left < 0.0) break;
    }
    return last;
  }

  // The first expectation step of a start: each patch belongs to its nearest centre entirely.
  void share_by_nearest(const std::vector<Vec2>& centres) {
    components_.assign(centres.size(), {});
    for (std::size_t j = 0; j < centres.size(); ++j) components_[j].mean_m = centres[j];
    shares_.assign(patches_.size() * centres.size(), 0.0);
    for (std::size_t i = 0; i < patches_.size(); ++i) {
      const auto nearest =
          std::min_element(centres.begin(), centres.end(), [&](const Vec2& a, const Vec2& b) {
            return (a - patches_[i].center_m).squaredNorm() <
                   (b - patches_[i].center_m).squaredNorm();
          });
      shares_[i * centres.size() + static_cast<std::size_t>(nearest - centres.begin())] = 1.0;
    }
  }

  // Continues from given components: their shares come first, then full EM iterations.
  Climb climb_from(std::vector<Component> components) {
    components_ = std::move(components);
    expect();
    return climb(options_.iterations_max);
  }

  // EM iterations from the current shares. F is known after the expectation step that follows a
  // maximisation, so convergence is tested from the second iteration on.
  Climb climb(std::uint32_t iterations) {
    Climb climbed;
    for (std::uint32_t i = 0; i < iterations; ++i) {
      maximise();
      const double mean_log_likelihood = expect();
      const bool converged =
          i > 0 && mean_log_likelihood - climbed.history.back() < options_.tolerance;
      climbed.history.push_back(mean_log_likelihood);
      if (converged) break;
    }
    climbed.components = components_;
    return climbed;
  }

  // E-step: shares_[i][j] of component j in patch i. Returns F.
  double expect() {
    const std::size_t k = components_.size();
    const std::vector<LogDensity> densities(components_.begin(), components_.end());
    shares_.resize(patches_.size() * k);
    double sum = 0.0;
    for (std::size_t i = 0; i < patches_.size(); ++i) {
      double* share = &shares_[i * k];
      // Log-sum-exp: the largest term is subtracted before exp(), so far patches do not underflow
      // to 0/0.
      double highest = -std::numeric_limits<double>::infinity();
      for (std::size_t j = 0; j < k; ++j) {
        share[j] = densities[j].of(patches_[i]);
        highest = std::max(highest, share[j]);
      }
      double total = 0.0;
      for (std::size_t j = 0; j < k; ++j) {
        const double below = share[j] - highest;
        share[j] = below > kNoShare ? std::exp(below) : 0.0;
        total += share[j];
      }
      for (std::size_t j = 0; j < k; ++j) share[j] /= total;
      sum += patches_[i].weight * (highest + std::log(total));
    }
    return sum;
  }

  // M-step, in one sweep. Moments are summed about the old means, because sums about the origin
  // would cancel far away from it. Components without weight are removed.
  void maximise() {
    const std::size_t k = components_.size();
    std::vector<Sums> sums(k);
    for (std::size_t i = 0; i < patches_.size(); ++i) {
      for (std::size_t j = 0; j < k; ++j) {
        const double mass = patches_[i].weight * shares_[i * k + j];
        if (mass > 0.0) sums[j].add(mass, patches_[i], components_[j].mean_m);
      }
    }
    std::vector<Component> grown;
    for (std::size_t j = 0; j < k; ++j) {
      if (sums[j].weight <= kNothing) continue;
      grown.push_back(sums[j].component(components_[j].mean_m, options_.sigma_min_m));
    }
    components_ = std::move(grown);
  }

  std::vector<Patch> patches_;
  FitOptions options_;
  std::vector<Component> components_;
  std::vector<double> shares_;  // row-major [patches × components]
};

// Tries K = 1, 2, … and keeps the fit with the smallest BIC. The BIC is not convex in K, so a few
// numbers without gain are tolerated before the search ends.
Climb chosen_by_bic(Fitter& fitter, const FitOptions& options, Rng& rng) {
  Climb best;
  double best_bic = std::numeric_limits<double>::infinity();
  std::uint32_t without_gain = 0;
  for (std::uint32_t k = 1; k <= options.components_max && without_gain < kBicStepsWithoutGain;
       ++k) {
    Climb climbed = fitter.best_of_starts(k, rng);
    const double bic = fitter.bic(climbed);
    ++without_gain;
    if (bic >= best_bic) continue;
    best_bic = bic;
    best = std::move(climbed);
    without_gain = 0;
  }
  return best;
}

// Options may come from a mission file, so violations are errors of input and not assertions.
Result<void> check(const FitOptions& o) {
  const auto refuse = [](std::string what) { return fail(ErrorCode::kBadInput, std::move(what)); };
  if (o.components > kMaxComponents || o.components_max < 1 || o.components_max > kMaxComponents) {
    return refuse(fmt::format("fit: components must be from 1 to {}", kMaxComponents));
  }
  if (!(o.sigma_min_m >= Gaussian::kMinSigma_m && o.sigma_min_m <= Gaussian::kMaxSigma_m)) {
    return refuse(fmt::format("fit: sigma_min_m is {}; must be from {} to {} m", o.sigma_min_m,
                              Gaussian::kMinSigma_m, Gaussian::kMaxSigma_m));
  }
  if (o.starts < 1 || o.iterations_max < 1 || !(o.weight_min >= 0.0 && o.weight_min < 1.0)) {
    return refuse("fit: starts and iterations_max must be >= 1, weight_min in [0, 1)");
  }
  return {};
}

// The patches with positive weight, their weights scaled to sum 1.
Result<std::vector<Patch>> normalised(std::span<const Patch> patches) {
  std::vector<Patch> good;
  double sum = 0.0;
  for (const Patch& patch : patches) {
    const bool finite =
        std::isfinite(patch.weight) && patch.center_m.allFinite() && patch.spread_m2.allFinite();
    if (!finite || patch.weight < 0.0) {
      return fail(ErrorCode::kBadInput,
                  "fit: weights must be >= 0, and all numbers of a shape finite");
    }
    if (patch.weight == 0.0) continue;
    good.push_back(patch);
    sum += patch.weight;
  }
  if (good.empty() || !std::isfinite(sum)) {
    return fail(ErrorCode::kBadInput, "fit: the shape is empty; nothing of it has any weight");
  }
  for (Patch& patch : good) patch.weight /= sum;
  return good;
}

}  // namespace

Result<MixtureFit> fit_mixture(std::span<const Patch> patches, const FitOptions& options,
                               Rng& rng) {
  if (auto checked = check(options); !checked) return tl::unexpected(checked.error());
  auto good = normalised(patches);
  if (!good) return tl::unexpected(good.error());

  Fitter fitter(*std::move(good), options);
  Climb climbed = options.components > 0 ? fitter.best_of_starts(options.components, rng)
                                         : chosen_by_bic(fitter, options, rng);
  // Only the chosen fit drops light components; doing so inside the search would change its BIC.
  fitter.drop_light(climbed);

  std::vector<WeightedGaussian> components;
  double sum = 0.0;
  for (const Component& component : climbed.components) sum += component.weight;
  for (const Component& component : climbed.components) {
    auto gaussian = Gaussian::make(component.mean_m, component.covariance_m2);
    if (!gaussian) return tl::unexpected(gaussian.error());
    components.push_back({component.weight / sum, *gaussian});
  }
  auto mixture = Mixture::make(std::move(components));
  if (!mixture) return tl::unexpected(mixture.error());
  return MixtureFit{*std::move(mixture), std::move(climbed.history)};
}

}  // namespace swarm
