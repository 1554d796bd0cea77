// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/tail_limit.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::planner {
namespace {

constexpr double kEpsilon_m = -0.2;

std::vector<LineComponent> random_mixture(Rng& rng) {
  std::vector<LineComponent> line(1 + rng() % 12);
  double total = 0.0;
  for (LineComponent& c : line) {
    c = {uniform(rng, 0.01, 1.0), -uniform(rng, 0.5, 60.0), uniform(rng, 1.0, 10.0)};
    total += c.weight;
  }
  for (LineComponent& c : line) c.weight /= total;
  return line;
}

double row(const std::vector<LineComponent>& line, double z_m) {
  double sum = 0.0;
  for (const LineComponent& c : line) sum += c.weight * risk_share(c, z_m, kEpsilon_m);
  return sum;
}

TEST(TailLimit, ReportsWhetherTheMixtureKeepsTheLimit) {
  Rng rng(1);
  int kept = 0;
  for (int i = 0; i < 2000; ++i) {
    const std::vector<LineComponent> line = random_mixture(rng);
    const double alpha = uniform(rng, 0.01, 0.4);
    const double cvar_m = mixture_tail_risk(line, alpha).cvar_m;
    // Within the tolerance of VaR the answer may be either.
    if (std::abs(cvar_m - kEpsilon_m) < 1e-9) continue;

    const TailAtLimit tail = tail_at_limit(line, kEpsilon_m);

    EXPECT_EQ(tail.probability <= alpha, cvar_m <= kEpsilon_m) << i;
    kept += cvar_m <= kEpsilon_m ? 1 : 0;
  }
  EXPECT_GT(kept, 200);
  EXPECT_LT(kept, 1800);
}

TEST(TailLimit, ItsTailHasTheLimitAsMean) {
  Rng rng(2);
  for (int i = 0; i < 500; ++i) {
    const std::vector<LineComponent> line = random_mixture(rng);

    const TailAtLimit tail = tail_at_limit(line, kEpsilon_m);

    if (tail.probability < 1e-6 || tail.probability > 0.99) continue;
    // CVaR at its own level is the limit, from the other implementation.
    EXPECT_NEAR(mixture_tail_risk(line, tail.probability).cvar_m, kEpsilon_m, 1e-7) << i;
  }
}

TEST(TailLimit, ARowNeverAdmitsWhatBreaksTheLimit) {
  Rng rng(3);
  int admitted = 0;
  for (int i = 0; i < 5000; ++i) {
    const double alpha = uniform(rng, 0.01, 0.3);
    const std::vector<LineComponent> here = random_mixture(rng);
    std::vector<LineComponent> there = here;  // the same components, other weights
    double total = 0.0;
    for (LineComponent& c : there) total += c.weight = uniform(rng, 0.0, 1.0);
    for (LineComponent& c : there) c.weight /= total;
    const double z_m = tail_at_limit(here, kEpsilon_m).from_m;

    if (row(there, z_m) > alpha) continue;

    ++admitted;
    EXPECT_LE(mixture_tail_risk(there, alpha).cvar_m, kEpsilon_m + 1e-9) << i;
  }
  EXPECT_GT(admitted, 500);
}

TEST(TailLimit, ARowIsTheTangentWhereTheLimitBinds) {
  // With α the tail's own probability the limit binds here, and z is VaR: eq. 22, divided by ε − z.
  Rng rng(4);
  for (int i = 0; i < 200; ++i) {
    const std::vector<LineComponent> line = random_mixture(rng);
    const TailAtLimit tail = tail_at_limit(line, kEpsilon_m);
    if (tail.probability < 1e-4 || tail.probability > 0.9) continue;
    const double alpha = tail.probability;

    const TailRisk risk = mixture_tail_risk(line, alpha);
    std::vector<double> gradient_m(line.size());
    mixture_cvar_gradient(line, alpha, risk.var_m, gradient_m);

    EXPECT_NEAR(risk.var_m, tail.from_m, 1e-6);
    EXPECT_NEAR(row(line, tail.from_m), alpha, 1e-9);
    for (std::size_t j = 0; j < line.size(); ++j) {
      EXPECT_NEAR(risk_share(line[j], tail.from_m, kEpsilon_m),
                  gradient_m[j] * alpha / (kEpsilon_m - tail.from_m), 1e-6);
    }
  }
}

TEST(TailLimit, NothingNearIsNoRisk) {
  EXPECT_EQ(tail_at_limit({}, kEpsilon_m).probability, 0.0);
  const std::vector<LineComponent> far{{1.0, -1000.0, 1.0}};
  EXPECT_EQ(tail_at_limit(far, kEpsilon_m).probability, 0.0);
}

TEST(TailLimit, AMixtureInsideTheObstacleIsAllTail) {
  const std::vector<LineComponent> inside{{0.5, 5.0, 1.0}, {0.5, 8.0, 2.0}};
  EXPECT_NEAR(tail_at_limit(inside, kEpsilon_m).probability, 1.0, 1e-12);
}

}  // namespace
}  // namespace swarm::planner
