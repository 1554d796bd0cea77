// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/horizon_program.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace swarm::planner {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The share of columns to begin with: fewer make more rounds, more make each slower.
constexpr double kFirstShare = 0.05;

// Reduced costs above this count as 0.
constexpr double kPriceTolerance = 1e-8;

// Each round adds columns, so this is never reached.
constexpr int kMaxRounds = 1000;

}  // namespace

// Chooses the first columns: the cheapest path from each source to each goal, which make the
// program feasible, the likely ones, and the share kFirstShare with the smallest detour.
HorizonProgram::HorizonProgram(const HorizonNetwork& network, std::span<const std::size_t> likely)
    : network_(&network),
      by_vertex_(network.horizon()),
      by_arc_(network.horizon()),
      is_active_(network.columns().size(), 0),
      row_basic_(network.right_side().size(), 1),
      is_met_(network.right_side().size(), 0) {
  const std::vector<double> detours = network.detours();
  std::vector<double> sorted = detours;
  const auto last = static_cast<std::ptrdiff_t>(kFirstShare * static_cast<double>(sorted.size()));
  std::nth_element(sorted.begin(), sorted.begin() + last, sorted.end());
  const double limit = sorted[static_cast<std::size_t>(last)];
  // Goal rows end a path; they need no column onward.
  for (std::size_t n = network.goal_row(0); n < is_met_.size(); ++n) is_met_[n] = 1;
  const Offers paths = offers(std::vector<double>(network.right_side().size(), 0.0));
  for (const std::size_t c : network.cheapest_routes()) enter(c, paths);
  for (const std::size_t c : likely) enter(c, paths);
  for (std::size_t c = 0; c < detours.size(); ++c) {
    if (detours[c] <= limit && std::isfinite(detours[c])) enter(c, paths);
  }
}

// Prices all columns outside the program, O(columns). A row that the program does not contain yet
// has no dual price; it gets the reduced cost of the cheapest path from it, by dynamic programming
// over the layers, so that a column into it is judged with all that has to follow.
HorizonProgram::Offers HorizonProgram::offers(std::span<const double> row_price) const {
  std::vector<double> price(row_price.begin(), row_price.end());
  for (std::size_t row = 0; row < is_met_.size(); ++row) {
    if (is_met_[row] == 0) price[row] = kInfinity;
  }
  Offers offers{std::vector<std::size_t>(is_met_.size(), is_active_.size()), {}};
  // From the last stage to the first, so that the row a column leads to has its price already.
  for (std::size_t c = is_active_.size(); c-- > 0;) {
    if (is_active_[c] != 0) continue;
    const HorizonNetwork::Column& column = network_->columns()[c];
    const std::size_t from = network_->row(column.stage, column.from);
    double reduced = column.cost;
    visit_column(c, [&](std::size_t row, double value) {
      if (row != from) reduced -= price[row] * value;
    });
    if (is_met_[from] != 0) {
      if (reduced - price[from] < -kPriceTolerance) offers.columns.push_back(c);
    } else if (reduced < price[from]) {
      price[from] = reduced;
      offers.path_on[from] = c;
    }
  }
  return offers;
}

// Adds a column and, at its two ends, the rows it needs with their paths onward.
void HorizonProgram::enter(std::size_t index, const Offers& offers) {
  const HorizonNetwork::Column& column = network_->columns()[index];
  meet(network_->row(column.stage, column.from), offers);
  activate(index, false);
  if (column.stage == network_->horizon()) return;
  meet(network_->row(column.stage + 1, column.to), offers);
}

// Adds a row to the program with the cheapest path onward from it. The first column of that path
// replaces the row in the basis, which stays triangular and as feasible as it was.
void HorizonProgram::meet(std::size_t row, const Offers& offers) {
  while (is_met_[row] == 0 && offers.path_on[row] < is_active_.size()) {
    const std::size_t c = offers.path_on[row];
    const HorizonNetwork::Column& column = network_->columns()[c];
    is_met_[row] = 1;
    row_basic_[row] = 0;
    activate(c, true);
    if (column.stage == network_->horizon()) return;
    row = network_->row(column.stage + 1, column.to);
  }
}

void HorizonProgram::activate(std::size_t column, bool is_basic) {
  if (is_active_[column] != 0) return;
  is_active_[column] = 1;
  active_.push_back(column);
  column_basic_.push_back(is_basic ? 1 : 0);
}

// Groups the coefficients of the weight rows by vertex and arc, so that visit_column() finds those
// of a column without a search.
void HorizonProgram::ask(std::span<const WeightRow> rows) {
  for (std::vector<Asks>* asks : {&by_vertex_, &by_arc_}) {
    for (Asks& step : *asks) {
      for (std::vector<Ask>& place : step) place.clear();
    }
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    Asks& asks = (rows[r].by_arc ? by_arc_ : by_vertex_)[rows[r].step - 1];
    if (asks.empty()) asks.resize(rows[r].by_arc ? network_->arcs() : network_->vertices());
    const auto row = static_cast<std::uint32_t>(network_->right_side().size() + r);
    for (const WeightRow::Entry& entry : rows[r].entries) {
      asks[entry.index].push_back({row, entry.coefficient});
    }
  }
  rows_ = rows.size();
  excess_basic_.resize(rows_, 0);
  row_basic_.resize(network_->right_side().size() + rows_, 1);
}

// Calls visit(row, value) for every entry of a column of the network.
template <class Visit>
void HorizonProgram::visit_column(std::size_t index, Visit visit) const {
  const HorizonNetwork::Column& column = network_->columns()[index];
  const auto visit_asks = [&](const Asks& asks, std::uint32_t place) {
    if (asks.empty()) return;
    for (const Ask& ask : asks[place]) visit(ask.row, ask.coefficient);
  };
  visit(network_->row(column.stage, column.from), 1.0);
  // A step's weights are sums over the arcs in; those of the last step over the fewer arcs out.
  if (column.stage == network_->horizon()) {
    visit(network_->goal_row(column.to), 1.0);
    visit_asks(by_vertex_[column.stage - 1], column.from);
    return;
  }
  visit(network_->row(column.stage + 1, column.to), -1.0);
  visit_asks(by_arc_[column.stage], column.arc);
  if (column.stage + 1 < network_->horizon()) visit_asks(by_vertex_[column.stage], column.to);
}

// The linear program of the given columns. Each weight row has a further column of its own, the
// excess s, which costs kExcessCost: the program is feasible even where the constraints are not.
LinearProgram HorizonProgram::program(std::span<const std::size_t> columns) const {
  LinearProgram lp;
  lp.row_lower = network_->right_side();
  lp.row_upper = network_->right_side();
  lp.row_lower.resize(lp.row_lower.size() + rows_, -kInfinity);
  lp.row_upper.resize(lp.row_upper.size() + rows_, 1.0);
  const auto put = [&](std::size_t row, double value) {
    lp.row_index.push_back(static_cast<int>(row));
    lp.value.push_back(value);
  };
  for (const std::size_t c : columns) {
    visit_column(c, put);
    lp.end_column(network_->columns()[c].cost);
  }
  for (std::size_t r = 0; r < rows_; ++r) {
    put(network_->right_side().size() + r, -1.0);
    lp.end_column(kExcessCost);
  }
  return lp;
}

LinearProgram HorizonProgram::whole(std::span<const WeightRow> rows) {
  ask(rows);
  std::vector<std::size_t> all(network_->columns().size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return program(all);
}

// Column generation: solve, price, add, until no column outside has a negative reduced cost. The
// first round follows a change of rows, hence the dual simplex.
LpSolution HorizonProgram::solve(std::span<const WeightRow> rows) {
  ask(rows);
  int pivots = 0;
  LpMethod method = LpMethod::kDualSimplex;
  for (int round = 0; round < kMaxRounds; ++round) {
    LpBasis basis{column_basic_, row_basic_};
    basis.column_basic.insert(basis.column_basic.end(), excess_basic_.begin(), excess_basic_.end());
    LpSolution solution = planner::solve(program(active_), basis, method);
    pivots += solution.pivots;
    solution.pivots = pivots;
    if (solution.status != LpStatus::kOptimal) return solution;
    const auto excess = basis.column_basic.begin() + static_cast<std::ptrdiff_t>(active_.size());
    column_basic_.assign(basis.column_basic.begin(), excess);
    excess_basic_.assign(excess, basis.column_basic.end());
    row_basic_ = std::move(basis.row_basic);
    const std::size_t solved = active_.size();
    const Offers better = offers(solution.row_price);
    for (const std::size_t c : better.columns) enter(c, better);
    if (better.columns.empty()) {
      std::vector<double> x(is_active_.size(), 0.0);
      for (std::size_t i = 0; i < solved; ++i) x[active_[i]] = solution.x[i];
      solution.x = std::move(x);
      return solution;
    }
    method = LpMethod::kPrimalSimplex;  // the basis stays feasible when columns join
  }
  return {};
}

}  // namespace swarm::planner
