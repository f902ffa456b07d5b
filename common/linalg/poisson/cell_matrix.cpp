// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/poisson/cell_matrix.hpp"

#include <utility>

#include "common/base/processor_clones.hpp"

namespace couplet::linalg {
namespace {

/// The faces of each owned cell, one cell after the other: first[c] to first[c + 1] of `face`.
struct FacesOfCells {
  std::vector<Index> first, face;
  explicit FacesOfCells(const CellGraph& graph) : first(std::size_t(graph.cells.n_owned()) + 1, 0) {
    const Index owned = graph.cells.n_owned();
    const auto each = [&](const auto& visit) {
      for (std::size_t f = 0; f < graph.owner.size(); ++f)
        for (const Index cell : {graph.owner[f], graph.neighbour[f]})
          if (cell < owned) visit(cell, static_cast<Index>(f));
    };
    each([&](Index cell, Index) { ++first[cell + 1]; });
    for (Index c = 0; c < owned; ++c) first[c + 1] += first[c];
    face.resize(first.back());
    std::vector<Index> next(first.begin(), first.end() - 1);
    each([&](Index cell, Index f) { face[next[cell]++] = f; });
  }
  std::span<const Index> of(Index cell) const {
    return std::span<const Index>(face).subspan(first[cell], first[cell + 1] - first[cell]);
  }
};

}  // namespace

CellMatrix::CellMatrix(const CellGraph& graph) : graph_(graph), slot_(2 * graph.owner.size(), -1) {
  const FacesOfCells faces(graph);
  const Index owned = graph.cells.n_owned(), room = static_cast<Index>(with_room(graph.cells.n_local()));
  std::vector<Slices<double>::Entry> entries;
  for (Index first = 0; first < owned; first += slice_width) {
    entries.clear();
    for (Index c = first; c < std::min(first + slice_width, owned); ++c)
      for (const Index f : faces.of(c)) {
        if (graph.owner[f] == graph.neighbour[f]) continue;  // periodic, one cell across: no difference
        const bool owns = graph.owner[f] == c;
        entries.push_back({c, owns ? graph.neighbour[f] : graph.owner[f], 2 * f + !owns});
      }
    slices_.add(first, entries, room,
                [&](Index slot, std::size_t at) { slot_[slot] = static_cast<Index>(at); });
  }
  diagonal_.assign(std::size_t(slices_.size()) * slice_width, 0.0);
}

void CellMatrix::fill(std::span<const double> diagonal, std::span<const double> faces) {
  std::ranges::copy(diagonal, diagonal_.begin());
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const Index slot : {slot_[2 * f], slot_[2 * f + 1]})
      if (slot >= 0) slices_.value[slot] = faces[f];
}

[[gnu::always_inline]] inline double CellMatrix::multiply_loop(const double* x, double* y) const {
  Eight<double> product{}, d, own;
  for (Index s = 0, n = slices_.size(); s < n; ++s) {
    load(diagonal_.data() + std::size_t(s) * slice_width, d);
    load(x + std::size_t(s) * slice_width, own);
    Eight<double> sum = d * own;
    slices_.multiply(s, x, sum);
    store(sum, y + std::size_t(s) * slice_width);
    product += own * sum;
  }
  return sum_of<double>(product);
}

COUPLET_PROCESSOR_CLONES double multiply_pass(const CellMatrix& a, const double* x, double* y) {
  return a.multiply_loop(x, y);
}

double CellMatrix::multiply(const double* x, double* y) const { return multiply_pass(*this, x, y); }

/// Neighbours ascending; two faces between the same cells are one entry.
CellMatrix::Rows CellMatrix::rows(std::span<const double> faces, bool zeros) const {
  const FacesOfCells all(graph_);
  Rows rows;
  std::vector<std::pair<Index, double>> row;
  for (Index c = 0; c < graph_.cells.n_owned(); ++c) {
    row.clear();
    for (const Index f : all.of(c))
      if ((zeros || faces[f] != 0) && graph_.owner[f] != graph_.neighbour[f])
        row.emplace_back(graph_.owner[f] == c ? graph_.neighbour[f] : graph_.owner[f], faces[f]);
    std::ranges::sort(row);
    for (const auto& [column, value] : row) {
      const bool again = Index(rows.index.size()) > rows.offset.back() && rows.index.back() == column;
      if (again) {
        rows.value.back() += value;
        continue;
      }
      rows.index.push_back(column);
      rows.value.push_back(value);
    }
    rows.offset.push_back(static_cast<Index>(rows.index.size()));
  }
  return rows;
}

}  // namespace couplet::linalg
