// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/tied/tied_matrix.hpp"

#include <algorithm>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"
#include "common/elasticity/tied/tied_assembly.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {
namespace {

class Parts {
 public:
  Parts(const mesh::Mesh& mesh, const ElasticOperator& rows, const TiedUnknowns& unknowns,
        const TiedParts& parts, TiedAssembly& to)
      : mesh_(mesh), geometry_(rows.geometry()), rows_(rows), unknowns_(unknowns), parts_(parts), to_(to) {}

  void add_faces();
  void add_edges();
  void add_volumes();
  template <int D>
  void add_mass() {
    SymmetricSpace<D> space(mesh_, rows_);
    space.set_density(parts_.density);
    to_.add_mass(parts_.mass, space.node_mass(), space.point_mass());
  }

 private:
  GradientStiffness of_face(Index f) const {
    GradientStiffness c = GradientStiffness::Zero();
    if (parts_.stiffness != 0)
      c = parts_.stiffness *
          (rows_.is_anisotropic()
               ? stiffness_of(face_matrix(mesh_, rows_, f))
               : stiffness_of(part_of_faces(face_lame(mesh_, rows_, f), rows_.volume_strain())));
    if (parts_.stress != 0)
      c += parts_.stress * stiffness_of_stress(parts_.prestress->stress[std::size_t(f)]);
    return c;
  }

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const ElasticOperator& rows_;
  const TiedUnknowns& unknowns_;
  const TiedParts& parts_;
  TiedAssembly& to_;
};

void Parts::add_faces() {
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    if (mesh_.owner[f] >= mesh_.cells.n_owned()) continue;  // its owner's rank adds it
    const bool shares = mesh_.dim == 3 && mesh_.face_points[f].size() == 3;
    const double volume = mesh_.dim == 2 ? symmetric_face<2>(mesh_, rows_, f).volume
                                         : symmetric_face<3>(mesh_, rows_, f).volume;
    to_.add(face_terms(mesh_, rows_, unknowns_, f),
            (shares ? 1 - SharedEdges::share : 1) * volume * of_face(f));
  }
}

void Parts::add_edges() {
  const SharedFaces shared = shared_faces(mesh_, rows_);
  if (!parallel::any(mesh_.comm, shared.n_mine > 0)) return;
  SharedEdges edges(mesh_, rows_, shared.faces, shared.volume);
  if (parts_.stress != 0) find_edge_stresses(shared, parts_.prestress->stress, edges);
  const std::vector<std::vector<TiedTerm>> terms = edge_terms(mesh_, rows_, unknowns_, shared, edges);
  for (Index e = 0; e < Index(edges.n_edges()); ++e) {
    if (terms[std::size_t(e)].empty()) continue;
    GradientStiffness c = GradientStiffness::Zero();
    if (parts_.stiffness != 0)
      c = parts_.stiffness *
          (rows_.is_anisotropic() ? stiffness_of(edges.matrix(e)) : stiffness_of(edges.lame(e)));
    if (parts_.stress != 0) c += parts_.stress * stiffness_of_stress(edge_tensor(edges, e));
    to_.add(terms[std::size_t(e)], edges.volume(e) * c);
  }
}

void Parts::add_volumes() {
  if (!rows_.volume_by_cells() || parts_.stiffness == 0) return;
  const Index n_owned = mesh_.cells.n_owned();
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const auto [here, there] = pyramids(mesh_, geometry_, f);
    for (const TiedTerm& t : face_terms(mesh_, rows_, unknowns_, f)) {
      const Vec3 g = t.turn.transpose() * t.b;
      if (mesh_.owner[f] < n_owned) to_.add_volume_term(mesh_.owner[f], t.block, here * g);
      if (f < mesh_.n_interior && mesh_.neighbour[f] < n_owned)
        to_.add_volume_term(mesh_.neighbour[f], t.block, there * g);
    }
  }
  const std::vector<double> volume = pyramid_volumes(mesh_, geometry_);
  to_.finish_volumes([&](Index c) {
    return parts_.stiffness * bulk_of_cells(rows_.lame(c), rows_.volume_strain()) / volume[std::size_t(c)];
  });
}

}  // namespace

bool TiedMatrix::suits(const mesh::Mesh& mesh) {
  return !parallel::any(mesh.comm, !mesh.neighbour_shift.empty());
}

TiedMatrix::TiedMatrix(const mesh::Mesh& mesh, const ElasticOperator& rows, const TiedParts& parts)
    : mesh_(mesh), rows_(rows), unknowns_(mesh, rows), matrix_(assemble(parts)) {
  const std::size_t n = unknowns_.n_blocks() * std::size_t(mesh.dim);
  from_.resize(n);
  to_.resize(n);
  n_rows_ = parallel::sum(mesh.comm, GlobalIndex(n));
  n_ties_ = parallel::sum(mesh.comm, GlobalIndex(unknowns_.points().size()) * mesh.dim);
}

linalg::SparseMatrix TiedMatrix::assemble(const TiedParts& parts) {
  TiedAssembly assembly(mesh_, rows_, unknowns_);
  Parts all(mesh_, rows_, unknowns_, parts, assembly);
  all.add_faces();
  all.add_edges();
  all.add_volumes();
  if (parts.stiffness != 0) assembly.add_supports();
  if (parts.stress != 0) assembly.add_places(parts.stress, parts.prestress->pressure);
  if (parts.mass != 0) mesh_.dim == 2 ? all.add_mass<2>() : all.add_mass<3>();
  return assembly.matrix(tie_);
}

/// The ties give the vertices, and their transpose takes the forces on these back.
void TiedMatrix::apply(std::span<const double> x, std::span<double> y) {
  const std::size_t dim = std::size_t(mesh_.dim), n = unknowns_.n_nodes() * dim,
                    m = unknowns_.points().size() * dim;
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
