// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/solve/elastic_preconditioner.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <utility>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/symmetric/symmetric_matrix.hpp"

namespace couplet::elastic {
namespace {

// The coarse correction of each level is multiplied by a factor, because
// smooth motions are softer than component by component. Parts of the diagonal of K are added. Iterations to
// 1e-8: 47 instead of 88 for a plate of 32x48x24 hexahedra, 136 instead of 350 for a porous body of 115 500
// tetrahedra, 69 instead of 135 for Cook's membrane of 64x64.
constexpr float of_smooth = 1.3F;
constexpr double of_cells = 0.8, of_faces = 0.85;

ComponentCycle multigrid_cycle(linalg::ComponentMultigrid::Rows rows,
                               const linalg::ComponentMultigrid::MultigridOptions& options) {
  return [multigrid = std::make_shared<linalg::ComponentMultigrid>(std::move(rows), options)](
             std::span<const double> b, std::span<double> x, int components) {
    multigrid->apply(b, x, components);
  };
}

/// Block `own` of a face with supports: springs in free directions, `whole` in known ones.
Tensor3 supported(const Tensor3& own, const BoundaryRow& s, double area, double whole) {
  const Tensor3 open = Tensor3::Identity() - s.known;
  return open * (own + area * s.spring) * open + whole * s.known;
}

/// Stiffness of a two-point flux along the normal, used for known directions [N/m].
double stiffness_across(const LameConstants& lame, const fv::FaceLine& line) {
  return (2 * lame.mu + lame.lambda) * line.area * line.inverse_dn;
}

/// Two-point rows of the owned cells. Boundary faces and bonds to other ranks are only on the diagonal.
class CompactRows {
 public:
  using Lanes = linalg::ComponentMultigrid::Lanes;

  CompactRows(const mesh::Mesh& mesh, const ElasticOperator& rows, VolumeStrain left_out)
      : mesh_(mesh), geometry_(rows.geometry()), rows_(rows), left_out_(left_out) {}

  linalg::ComponentMultigrid::Rows make(std::span<const double> inertia);

 private:
  bool owned(Index c) const { return c < mesh_.cells.n_owned(); }
  /// |S| / (d . n) [mu + (mu + lambda) n_c^2] per component.
  Lanes coefficient(Index f) const;
  /// Contribution of a boundary face to the diagonal of its cell.
  Lanes boundary_diagonal(Index f) const;
  /// Both sides of a bonded face in series.
  Lanes bond(Index f) const;
  template <class Take>
  void visit_couplings(const Take& take) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const ElasticOperator& rows_;
  VolumeStrain left_out_;
};

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
  for (int c = 0; c < mesh_.dim; ++c) k[c] = here[c] * there[c] / (here[c] + there[c]);
  return k;
}

CompactRows::Lanes CompactRows::boundary_diagonal(Index f) const {
  Lanes k = coefficient(f);
  const fv::FaceLine line = fv::face_line(mesh_, geometry_, f);
  const BoundaryRow& row = rows_.at(f);
  if (row.shared) return bond(f);
  for (int c = 0; c < mesh_.dim; ++c) {
    const double known = row.known(c, c), spring = line.area * row.spring(c, c);
    const double whole = k[c];
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

}  // namespace

ElasticPreconditioner::ElasticPreconditioner(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                             const Options& options)
    : mesh_(&mesh),
      geometry_(&rows.geometry()),
      rows_(&rows),
      left_out_(options.without_cells_bulk ? rows.volume_strain() : VolumeStrain::faces) {
  const std::span<const double> of_cells =
      options.node_inertia.first(options.node_inertia.empty() ? 0 : std::size_t(mesh.cells.n_owned()));
  linalg::ComponentMultigrid::Rows compact = CompactRows(mesh, rows, left_out_).make(of_cells);
  const linalg::ComponentMultigrid::MultigridOptions of_cycle{of_smooth, &mesh.cells, mesh.comm};
  cycle_ = options.cycle ? options.cycle(std::move(compact), of_cycle)
                         : multigrid_cycle(std::move(compact), of_cycle);
  find_face_rows(options.node_inertia);
  add_true_diagonal(options.node_inertia);
}

void ElasticPreconditioner::find_face_rows(std::span<const double> node_inertia) {
  const mesh::Mesh& mesh = *mesh_;
  const mesh::Geometry& geometry = *geometry_;
  const auto stiffness = [&](Index f) {
    const LameConstants lame = part_of_faces(rows_->lame(mesh.owner[f]), left_out_);
    const fv::FaceLine line = fv::face_line(mesh, geometry, f);
    const Vec3& n = line.normal;
    const double scale = line.area * line.inverse_dn;
    return Tensor3(scale * (lame.mu * Tensor3::Identity() + (lame.mu + lame.lambda) * n * n.transpose()));
  };
  for (const Index f : rows_->unknown_faces()) {
    Tensor3 own = stiffness(f), cell = own;
    FaceElimination row{Tensor3::Zero(), Tensor3::Zero(), Tensor3::Zero(), mesh.owner[f], -1};
    const BoundaryRow& s = rows_->at(f);
    if (s.has_value()) {
      const Tensor3 open = Tensor3::Identity() - s.known;
      const fv::FaceLine line = fv::face_line(mesh, geometry, f);
      cell = (open * own * open).eval();
      own = supported(own, s, line.area, stiffness_across(rows_->lame(mesh.owner[f]), line));
    }
    if (s.shared) {
      const Index twin = mesh.n_interior + mesh.twin[f - mesh.n_interior];
      const Tensor3 other = stiffness(twin);
      own += other;
      // If the other cell is on another rank, its part goes to this one, so that constants stay constant.
      if (mesh.owner[twin] < mesh.cells.n_owned()) {
        row.twin_owner = mesh.owner[twin];
        row.other = own.inverse() * other;
      } else {
        cell += other;
      }
    }
    if (!node_inertia.empty())
      own += node_inertia[std::size_t(mesh.cells.n_owned()) + face_rows_.size()] * Tensor3::Identity();
    row.inverse = own.inverse();
    row.cell = row.inverse * cell;
    face_rows_.push_back(row);
  }
}

/// Adds the diagonal of K for high frequencies. Inside hexahedra it is a third of the compact operator's, but
/// up to 1.6 times as much at cells and faces with many vertices.
void ElasticPreconditioner::add_true_diagonal(std::span<const double> node_inertia) {
  const mesh::Mesh& mesh = *mesh_;
  const mesh::Geometry& geometry = *geometry_;
  const SymmetricDiagonal diagonal = symmetric_diagonal(mesh, *rows_, left_out_);
  const std::size_t dim = mesh.dim, n_cells = std::size_t(mesh.cells.n_owned());
  gathered_.resize(n_cells * dim);
  const auto inertia = [&](std::size_t node) { return node_inertia.empty() ? 0 : node_inertia[node]; };
  for (std::size_t i = 0; i < n_cells * dim; ++i)
    inverse_diagonal_.push_back(static_cast<float>(of_cells / (diagonal.cells[i] + inertia(i / dim))));
  for (std::size_t i = 0; i < face_rows_.size(); ++i) {
    const Index f = rows_->unknown_faces()[i];
    Tensor3 own = diagonal.faces[i] + inertia(n_cells + i) * Tensor3::Identity();
    if (rows_->at(f).has_value()) {
      const fv::FaceLine line = fv::face_line(mesh, geometry, f);
      own = supported(own, rows_->at(f), line.area, stiffness_across(rows_->lame(mesh.owner[f]), line));
    }
    face_rows_[i].inverse = of_faces * own.inverse();
  }
}

/// Computes u_B of the boundary faces from their own rows and the cells' part of z.
void ElasticPreconditioner::solve_faces(std::span<const double> r, std::span<double> z) const {
  const int dim = mesh_->dim;
  const std::size_t n_cells = std::size_t(mesh_->cells.n_owned()) * dim;
  for (std::size_t i = 0; i < face_rows_.size(); ++i) {
    const FaceElimination& row = face_rows_[i];
    const double* own = r.data() + n_cells + i * dim;
    const double* cell = z.data() + std::size_t(row.owner) * dim;
    for (int a = 0; a < dim; ++a) {
      double u = 0;
      for (int b = 0; b < dim; ++b) u += row.inverse(a, b) * own[b] + row.cell(a, b) * cell[b];
      if (row.twin_owner >= 0)
        for (int b = 0; b < dim; ++b) u += row.other(a, b) * z[std::size_t(row.twin_owner) * dim + b];
      z[n_cells + i * dim + a] = u;
    }
  }
}

/// Applies [1, C^T] before the cycle and [1; C] after it, and adds the diagonal of K.
void ElasticPreconditioner::apply(std::span<const double> r, std::span<double> z) {
  const int dim = mesh_->dim;
  const std::size_t n_cells = gathered_.size();
  std::copy_n(r.begin(), n_cells, gathered_.begin());
  for (std::size_t i = 0; i < face_rows_.size(); ++i) {
    const FaceElimination& row = face_rows_[i];
    const double* own = r.data() + n_cells + i * dim;
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b) {
        gathered_[std::size_t(row.owner) * dim + a] += row.cell(b, a) * own[b];
        if (row.twin_owner >= 0) gathered_[std::size_t(row.twin_owner) * dim + a] += row.other(b, a) * own[b];
      }
  }
  cycle_(gathered_, z.first(n_cells), dim);
  solve_faces(r, z);
  for (std::size_t i = 0; i < n_cells; ++i) z[i] += inverse_diagonal_[i] * r[i];
}

}  // namespace couplet::elastic
