// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/cell_solver.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "common/linalg/component_multigrid.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::linalg {
namespace {

using Cycle = AggregationMultigrid<float>;

// Ratios of row sum and diagonal. The first is round-off: x is known up to a constant. The second is small
// but determines a constant that multigrid in single precision would lose (a closed, stiff fluid).
constexpr double round_off = 1e-13, little = 1e-5;

/// Rows of the owned cells with ascending neighbors. Faces between the same cells are merged, zero ones
/// omitted.
Cycle::Rows rows_of(const CellGraph& graph, std::span<const double> diagonal, std::span<const double> faces) {
  const Index owned = graph.cells.n_owned();
  std::vector<std::vector<std::pair<Index, double>>> all(owned);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Index a = graph.owner[f], b = graph.neighbour[f];
    if (faces[f] == 0 || a == b) continue;  // periodic with one cell across: no difference
    if (a < owned) all[a].emplace_back(b, faces[f]);
    if (b < owned) all[b].emplace_back(a, faces[f]);
  }
  Cycle::Rows rows;
  rows.diagonal.assign(diagonal.begin(), diagonal.end());
  for (std::vector<std::pair<Index, double>>& row : all) {
    std::ranges::sort(row);
    for (std::size_t e = 0; e < row.size(); ++e) {
      double value = row[e].second;
      for (; e + 1 < row.size() && row[e + 1].first == row[e].first; ++e) value += row[e + 1].second;
      rows.index.push_back(row[e].first);
      rows.value.push_back(static_cast<float>(value));
    }
    rows.offset.push_back(static_cast<Index>(rows.index.size()));
  }
  return rows;
}

}  // namespace

CellSolver::CellSolver(std::string what, const CellGraph& graph, Preconditioner kind)
    : graph_(graph),
      matrix_(make_matrix()),
      solver_(std::move(what), matrix_,
              {.method =
                   kind == Preconditioner::factors ? LinearMethod::cg_direct : LinearMethod::cg_multigrid}) {
  if (kind == Preconditioner::multigrid) solver_.set_preconditioner([this] { return make_cycle(); });
}

// Triplets: the diagonal of each owned cell, then the neighbors by face.
SparseMatrix CellSolver::make_matrix() {
  const parallel::IndexMap& cells = graph_.cells;
  const Index owned = cells.n_owned();
  std::vector<GlobalIndex> row(owned), column;
  std::iota(row.begin(), row.end(), cells.first());
  column = row;
  const auto add = [&](Index from, Index to) {
    if (from >= owned) return;
    row.push_back(cells.global(from));
    column.push_back(cells.global(to));
  };
  for (std::size_t f = 0; f < graph_.owner.size(); ++f) {
    add(graph_.owner[f], graph_.neighbour[f]);
    add(graph_.neighbour[f], graph_.owner[f]);
  }
  values_.resize(row.size());
  return SparseMatrix(graph_.comm, owned, std::move(row), std::move(column));
}

void CellSolver::fill(std::span<const double> diagonal, std::span<const double> faces) {
  diagonal_.assign(diagonal.begin(), diagonal.end());
  faces_.assign(faces.begin(), faces.end());
  auto next = std::ranges::copy(diagonal, values_.begin()).out;
  const Index owned = graph_.cells.n_owned();
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const Index cell : {graph_.owner[f], graph_.neighbour[f]})
      if (cell < owned) *next++ = faces[f];
  matrix_.fill(values_);
  solver_.matrix_changed();
}

/// V-cycle in single precision. If a constant is almost undetermined, it is solved separately by 1/(1.A 1).
LinearMap CellSolver::make_cycle() const {
  std::vector<double> sums = diagonal_;
  const Index owned = graph_.cells.n_owned();
  std::vector<char> is_coupled(sums.size(), 0);
  for (std::size_t f = 0; f < faces_.size(); ++f)
    for (const Index cell : {graph_.owner[f], graph_.neighbour[f]})
      if (cell < owned && faces_[f] != 0 && graph_.owner[f] != graph_.neighbour[f])
        sums[cell] += faces_[f], is_coupled[cell] = 1;
  double largest = 0, all = 0;
  for (std::size_t c = 0; c < sums.size(); ++c)
    if (is_coupled[c]) largest = std::max(largest, std::abs(sums[c]) / diagonal_[c]), all += sums[c];
  largest = parallel::max(graph_.comm, largest);
  all = parallel::sum(graph_.comm, all);
  const bool closed = largest < little;
  const double constant = closed && largest > round_off ? 1 / all : 0;
  const auto cycle = std::make_shared<Cycle>(rows_of(graph_, diagonal_, faces_),
                                             Cycle::MultigridOptions{1, &graph_.cells, graph_.comm, closed});
  return [cycle, constant, comm = graph_.comm](std::span<const double> b, std::span<double> x) {
    cycle->apply(b, x, 1);
    if (constant == 0) return;
    const double level = constant * parallel::sum(comm, std::accumulate(b.begin(), b.end(), 0.0));
    for (double& value : x) value += level;
  };
}

}  // namespace couplet::linalg
