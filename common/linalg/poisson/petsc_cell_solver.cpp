// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/poisson/petsc_cell_solver.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace couplet::linalg {

PetscCellSolver::PetscCellSolver(std::string what, const CellGraph& graph, const Beside& beside,
                                 LinearMethod method)
    : graph_(graph),
      matrix_(make_matrix(beside)),
      solver_(std::move(what), matrix_, LinearOptions{.method = method}) {}

// Triplets: the diagonal of each owned cell first, then the neighbours face by face, then what is coupled beside.
SparseMatrix PetscCellSolver::make_matrix(const Beside& beside) {
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
  for (const Index cell : beside.row) row.push_back(cells.global(cell));
  column.insert(column.end(), beside.column.begin(), beside.column.end());
  values_.resize(row.size());
  return SparseMatrix(graph_.comm, owned, std::move(row), std::move(column));
}

void PetscCellSolver::fill(std::span<const double> diagonal, std::span<const double> faces,
                           std::span<const double> beside) {
  auto next = std::ranges::copy(diagonal, values_.begin()).out;
  const Index owned = graph_.cells.n_owned();
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const Index cell : {graph_.owner[f], graph_.neighbour[f]})
      if (cell < owned) *next++ = faces[f];
  std::ranges::copy(beside, next);
  matrix_.fill(values_);
  solver_.matrix_changed();
}

}  // namespace couplet::linalg
