// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/tied_matrix.hpp"

#include <algorithm>

#include "common/elasticity/symmetric/shared_edges.hpp"
#include "common/fv/vertex_interpolation.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {

bool TiedMatrix::suits(const mesh::Mesh& mesh) {
  return !parallel::any(mesh.comm, !mesh.neighbour_shift.empty());
}

TiedMatrix::TiedMatrix(const mesh::Mesh& mesh, const ElasticOperator& rows, const EnergyParts& parts)
    : mesh_(mesh),
      rows_(rows),
      n_nodes_(std::size_t(mesh.cells.n_owned()) + rows.unknown_faces().size()),
      matrix_(assemble(parts)) {
  const std::size_t n = (n_nodes_ + 2 * points_.size()) * std::size_t(mesh.dim);
  from_.resize(n);
  to_.resize(n);
  n_ties_ = parallel::sum(mesh.comm, GlobalIndex(points_.size()) * mesh.dim);
}

/// Numbers nodes, points and multipliers. Collective.
void TiedMatrix::number_all() {
  for (Index v = 0; v < mesh_.points.n_owned(); ++v)
    if (!rows_.constraints().is_fixed(v) && !rows_.vertices().nodes(v).empty()) points_.push_back(v);
  number_ = {fv::number_nodes(mesh_, rows_.unknown_faces()),
             std::vector<GlobalIndex>(std::size_t(mesh_.points.n_local()), -1)};
  // Points and multipliers of lower ranks shift the node numbers of each rank.
  struct Rank {
    GlobalIndex first_node, shift;
  };
  const auto n_points = GlobalIndex(points_.size());
  const Rank here{parallel::exclusive_scan(mesh_.comm, GlobalIndex(n_nodes_)),
                  2 * parallel::exclusive_scan(mesh_.comm, n_points)};
  const std::vector<Rank> ranks = parallel::all_gather(mesh_.comm, std::vector<Rank>{here});
  for (GlobalIndex& n : number_.node) {
    if (n < 0) continue;
    const auto after = std::ranges::upper_bound(ranks, n, {}, &Rank::first_node);
    n += std::prev(after)->shift;
  }
  const GlobalIndex first_point = here.first_node + here.shift + GlobalIndex(n_nodes_);
  for (std::size_t i = 0; i < points_.size(); ++i)
    number_.point[std::size_t(points_[i])] = first_point + GlobalIndex(i);
  mesh_.points.update_ghosts(std::span<GlobalIndex>(number_.point));
  first_multiplier_ = first_point + n_points;
}

/// Adds the ties u_V = F_V sum_i w_i u_i, times `tie_`.
void TiedMatrix::add_ties(Assembly& assembly) const {
  const auto both = [&](GlobalIndex i, GlobalIndex j, const Tensor3& block) {
    assembly.add(i, j, block);
    assembly.add(j, i, block.transpose());
  };
  const Numbering of_nodes{number_.node, {}};
  FaceTerms means(mesh_, rows_, of_nodes);
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const GlobalIndex multiplier = first_multiplier_ + GlobalIndex(k);
    both(multiplier, number_.point[points_[k]], tie_ * Tensor3::Identity());
    for (const FaceTerm& t : means.of_point(points_[k])) both(multiplier, t.block, -tie_ * t.b[0] * t.turn);
  }
}

linalg::SparseMatrix TiedMatrix::assemble(const EnergyParts& parts) {
  number_all();
  Assembly assembly(mesh_, rows_, number_);
  assembly.add_faces(parts, 1 - SharedEdges::share);
  assembly.add_edges(parts);
  assembly.add_volumes(parts);
  if (parts.stiffness != 0) assembly.add_supports();
  if (parts.stress != 0) assembly.add_places(parts.stress, parts.prestress->loads);
  if (parts.mass != 0) assembly.add_mass(parts.mass, parts.density);
  tie_ = assembly.mean_diagonal();
  add_ties(assembly);
  return assembly.matrix(n_nodes_ + 2 * points_.size());
}

/// Multiplies by A. The ties give the vertices, and their transpose returns the forces.
void TiedMatrix::apply(std::span<const double> x, std::span<double> y) {
  const std::size_t dim = std::size_t(mesh_.dim), n = n_nodes_ * dim, m = points_.size() * dim;
  std::ranges::fill(from_, 0);
  std::ranges::copy(x, from_.begin());
  matrix_.multiply(from_, to_);
  for (std::size_t i = 0; i < m; ++i) from_[n + i] = -to_[n + m + i] / tie_;
  matrix_.multiply(from_, to_);
  std::ranges::copy(std::span(to_).first(n), y.begin());
  std::ranges::fill(from_, 0);
  for (std::size_t i = 0; i < m; ++i) from_[n + m + i] = -to_[n + i] / tie_;
  matrix_.multiply(from_, to_);
  for (std::size_t i = 0; i < n; ++i) y[i] += to_[i];
}

void TiedMatrix::factorise() { factors_ = std::make_unique<linalg::SymmetricFactors>(matrix_); }

void TiedMatrix::solve(std::span<const double> x, std::span<double> y) {
  std::ranges::fill(from_, 0);
  std::ranges::copy(x, from_.begin());
  factors_->solve(from_, to_);
  std::ranges::copy(std::span(to_).first(y.size()), y.begin());
}

}  // namespace couplet::elastic
