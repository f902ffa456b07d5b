// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/solve/compact_rows.hpp"

#include <utility>

#include "common/elasticity/elastic_nodes.hpp"

namespace couplet::elastic {

CompactRows::Lanes CompactRows::coefficient(Index f) const {
  const LameConstants lame = part_of_faces(face_lame(mesh_, rows_, f), left_out_);
  const fv::FaceLine line = fv::face_line(mesh_, geometry_, f);
  const double scale = line.area * line.inverse_dn;
  Lanes k{};
  for (int c = 0; c < mesh_.dim; ++c) {
    const double nc = line.normal[c];
    k[c] = static_cast<float>(scale * (lame.mu + (lame.mu + lame.lambda) * nc * nc));
  }
  return k;
}

CompactRows::Lanes CompactRows::bond(Index f) const {
  const Lanes here = coefficient(f), there = coefficient(mesh_.n_interior + mesh_.twin[f - mesh_.n_interior]);
  Lanes k{};
  for (int c = 0; c < mesh_.dim; ++c)
    k[c] = static_cast<float>(boundary_factor_) * here[c] * there[c] / (here[c] + there[c]);
  return k;
}

CompactRows::Lanes CompactRows::boundary_diagonal(Index f) const {
  Lanes k = coefficient(f);
  const fv::FaceLine line = fv::face_line(mesh_, geometry_, f);
  const BoundaryRow& row = rows_.at(f);
  if (row.shared) return bond(f);
  for (int c = 0; c < mesh_.dim; ++c) {
    const double known = row.known(c, c), spring = line.area * row.spring(c, c);
    const double whole = (row.mirrored ? 1 : boundary_factor_) * k[c];
    // Spring and half cell in series.
    k[c] = static_cast<float>(whole * (known + (1 - known) * spring / (whole + spring)));
  }
  return k;
}

template <class Take>
void CompactRows::visit_couplings(const Take& take) const {
  for (Index f = 0; f < mesh_.n_interior; ++f) take(mesh_.owner[f], mesh_.neighbour[f], f);
  if (mesh_.twin.empty()) return;
  for (const Index f : rows_.unknown_faces()) {
    if (!rows_.at(f).shared) continue;
    const Index other = mesh_.owner[mesh_.n_interior + mesh_.twin[f - mesh_.n_interior]];
    if (owned(other)) take(mesh_.owner[f], other, f);
  }
}

linalg::ComponentMultigrid::Rows CompactRows::make(std::span<const double> inertia) {
  const Index n = mesh_.cells.n_owned();
  linalg::ComponentMultigrid::Rows result;
  result.offset.assign(n + 1, 0);
  visit_couplings([&](Index a, Index b, Index) {
    if (owned(a)) ++result.offset[a + 1];
    if (owned(b)) ++result.offset[b + 1];
  });
  for (Index c = 0; c < n; ++c) result.offset[c + 1] += result.offset[c];
  result.index.resize(result.offset.back());
  result.value.resize(result.offset.back());
  std::vector<Index> next(result.offset.begin(), result.offset.end() - 1);
  visit_couplings([&](Index a, Index b, Index f) {
    const Lanes k = f < mesh_.n_interior ? coefficient(f) : bond(f);
    for (const auto& [row, column] : {std::pair{a, b}, {b, a}}) {
      if (!owned(row)) continue;
      result.index[next[row]] = column;
      result.value[next[row]++] = -k;
    }
  });
  Lanes unused{};
  for (int c = mesh_.dim; c < linalg::ComponentMultigrid::lanes; ++c) unused[c] = 1;
  result.diagonal.assign(n, unused);
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const Lanes k = f < mesh_.n_interior ? coefficient(f) : boundary_diagonal(f);
    if (owned(mesh_.owner[f])) result.diagonal[mesh_.owner[f]] += k;
    if (f < mesh_.n_interior && owned(mesh_.neighbour[f])) result.diagonal[mesh_.neighbour[f]] += k;
  }
  for (std::size_t c = 0; c < inertia.size(); ++c)
    for (int a = 0; a < mesh_.dim; ++a) result.diagonal[c][a] += static_cast<float>(inertia[c]);
  return result;
}

}  // namespace couplet::elastic
