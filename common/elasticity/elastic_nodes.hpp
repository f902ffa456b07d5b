// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/lanes.hpp"

namespace couplet::elastic {

/// Lame constants of a face: those of the owner, or the mean across an interior face if cells differ.
inline LameConstants face_lame(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f) {
  const LameConstants here = rows.lame(mesh.owner[f]);
  if (f >= mesh.n_interior) return here;
  const LameConstants there = rows.lame(mesh.neighbour[f]);
  return {0.5 * (here.mu + there.mu), 0.5 * (here.lambda + there.lambda)};
}

/// Elastic matrix of a face, averaged likewise.
inline ElasticMatrix face_matrix(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f) {
  const ElasticMatrix& here = rows.elastic_matrix(mesh.owner[f]);
  if (f >= mesh.n_interior) return here;
  return 0.5 * (here + rows.elastic_matrix(mesh.neighbour[f]));
}

/// Number of faces whose force is needed. With bonded faces those of ghosts are included, because a bonded
/// row contains the force on the other side.
inline Index n_faces_with_force(const mesh::Mesh& mesh) {
  return mesh.twin.empty() ? mesh.n_flux_faces() : mesh.n_faces();
}

/// face_lame() of all faces with a force, stored once for a uniform body.
class FaceLames {
 public:
  FaceLames(const mesh::Mesh& mesh, const ElasticOperator& rows) : varies_(rows.is_uniform() ? 0 : 1) {
    const Index n = varies_ ? n_faces_with_force(mesh) : 1;
    for (Index f = 0; f < n; ++f) value_.push_back(varies_ ? face_lame(mesh, rows, f) : rows.lame(0));
  }
  const LameConstants& operator[](Index f) const { return value_[std::size_t(f) * varies_]; }

 private:
  std::size_t varies_;
  std::vector<LameConstants> value_;
};

/// Displacements of all nodes (local cells, then boundary faces) with four doubles each and space for more
/// locations, and the forces on the cells. The node of a symmetry face is zero.
class ElasticNodes {
 public:
  static constexpr int stride = 4;

  ElasticNodes(const mesh::Mesh& mesh, const ElasticOperator& rows, Index n_further = 0)
      : mesh_(&mesh),
        rows_(&rows),
        value_(std::size_t(mesh.cells.n_local() + mesh.boundary.n_local() + n_further) * stride, 0.0) {}

  const double* operator[](Index node) const { return value_.data() + std::size_t(node) * stride; }
  double* value(Index node) { return value_.data() + std::size_t(node) * stride; }
  std::span<double> all() { return value_; }
  const double* of_face(Index face) const {
    return (*this)[mesh_->cells.n_local() + face - mesh_->n_interior];
  }
  double* force(Index cell) { return force_.data() + std::size_t(cell) * stride; }
  /// Zeroes the forces. Must precede their first use; allocates them on demand.
  void clear_forces() { force_.assign(std::size_t(mesh_->cells.n_local()) * stride, 0.0); }

  /// Sets the values of all local nodes. With `supports_hold`, supports take their known components
  /// regardless of the unknowns. Collective.
  template <int D>
  void fill(std::span<const double> unknowns, std::span<const double> known, bool supports_hold = false) {
    const Index n_owned = mesh_->cells.n_owned(), n_cells = mesh_->cells.n_local();
    const auto copy = [](const double* from, double* to) { std::copy_n(from, D, to); };
    for (Index c = 0; c < n_owned; ++c) copy(unknowns.data() + std::size_t(c) * D, value(c));
    const auto& open = rows_->unknown_faces();
    for (std::size_t i = 0; i < open.size(); ++i)
      copy(unknowns.data() + (n_owned + i) * D, value(n_cells + open[i] - mesh_->n_interior));
    for (const Index f : rows_->known_faces()) {
      double* here = value(n_cells + f - mesh_->n_interior);
      Vec3 g = Vec3::Zero();
      if (!known.empty()) copy(known.data() + std::size_t(rows_->known_of_face(f)) * D, g.data());
      if (rows_->at(f).fixed)
        copy(g.data(), here);
      else if (supports_hold)
        Eigen::Map<Vec3>(here) += rows_->at(f).known * (g - Eigen::Map<const Vec3>(here));
    }
    const std::span<double> cells = all().first(std::size_t(n_cells) * stride);
    mesh_->cells.update_ghosts(cells, stride);
    mesh_->boundary.update_ghosts(
        all().subspan(cells.size(), std::size_t(mesh_->boundary.n_local()) * stride), stride);
    for (std::size_t b = 0; b < mesh_->twin.size(); ++b) {
      const Index first = mesh_->twin[b];
      if (first < 0 || mesh_->boundary_id[first] > mesh_->boundary_id[b]) continue;
      copy(value(n_cells + first), value(n_cells + static_cast<Index>(b)));
    }
  }

 private:
  const mesh::Mesh* mesh_;
  const ElasticOperator* rows_;
  std::vector<double> value_, force_;
};

/// Vertices that a kernel interpolates or constrains: u_V = F_V sum_i w_i u_i + g_V.
class ElasticVertices {
 public:
  std::vector<Index> free;         ///< points that depend on nodes
  std::vector<Index> constrained;  ///< points with F_V other than I; those not in `free` have F_V = 0

  ElasticVertices(const mesh::Mesh& mesh, const ElasticOperator& rows) : rows_(&rows) {
    for (Index v = 0; v < mesh.points.n_local(); ++v) {
      if (rows.constraints().is_constrained(v)) constrained.push_back(v);
      if (!rows.constraints().is_fixed(v) && !rows.vertices().nodes(v).empty()) free.push_back(v);
    }
    free.shrink_to_fit();
  }

  /// Calls take(point) for all points that have a value.
  template <class Take>
  void visit(const Take& take) const {
    for (const Index v : free) take(v);
    for (const Index v : constrained) take(v);
  }

  /// Applies F_V and g_V to the first D of `stride` doubles per point.
  template <int D>
  void constrain(std::span<double> values, int stride, std::span<const double> known) const {
    const VertexConstraints& constraints = rows_->constraints();
    for (const Index v : constrained) {
      Eigen::Map<Vec<D>> u(values.data() + std::size_t(v) * stride);
      u = (constraints.free_part(v).topLeftCorner<D, D>() * u).eval();
      const Index column = constraints.column(v);
      if (column >= 0 && !known.empty())
        u += Eigen::Map<const Vec<D>>(known.data() + std::size_t(column) * D);
    }
  }

 private:
  const ElasticOperator* rows_;
};

}  // namespace couplet::elastic
