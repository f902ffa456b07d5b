// SPDX-License-Identifier: Apache-2.0
#include "common/fv/vertex_interpolation.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace couplet {
namespace {

// Directions the nodes do not span: eigenvalues of sum r r^T below this part of the largest (r are unit
// vectors, so that a cell of aspect ratio 1e5 still counts as spanning).
constexpr double spanned = 1e-12;
// No weighted mean of the nodes reaches the point: the weights cancel to this part of sum 1/d.
constexpr double reachable = 1e-8;
// Normals of a symmetry patch that differ by less than about 2 degrees are one plane.
constexpr double one_plane = 1e-3;

/// Least-norm solution of M lambda = -s.
Vec3 solve_lambda(const Tensor3& m, const Vec3& s, int dim) {
  if (dim == 2) {
    const double det = m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0), trace = m(0, 0) + m(1, 1);
    if (det > 1e-9 * trace * trace)
      return {-(m(1, 1) * s[0] - m(0, 1) * s[1]) / det, -(m(0, 0) * s[1] - m(1, 0) * s[0]) / det, 0};
  } else {
    const double trace = m.trace();
    if (m.determinant() > 1e-9 * trace * trace * trace) return -(m.inverse() * s);
  }
  const Eigen::SelfAdjointEigenSolver<Tensor3> eigen(m);
  Vec3 lambda = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    if (eigen.eigenvalues()[i] <= spanned * eigen.eigenvalues()[2]) continue;
    const Vec3 v = eigen.eigenvectors().col(i);
    lambda -= v * (v.dot(s) / eigen.eigenvalues()[i]);
  }
  return lambda;
}

/// I - sum of the directions n that span the normals (sum of n n^T given).
Tensor3 projector_from(const Tensor3& normals) {
  const Eigen::SelfAdjointEigenSolver<Tensor3> eigen(normals);
  Tensor3 projector = Tensor3::Identity();
  for (int i = 0; i < 3; ++i)
    if (eigen.eigenvalues()[i] > one_plane * eigen.eigenvalues()[2])
      projector -= eigen.eigenvectors().col(i) * eigen.eigenvectors().col(i).transpose();
  return projector;
}

}  // namespace

/// Cells and boundary faces (entries of mesh.boundary) around each point.
struct VertexInterpolation::Around {
  Csr cells, faces;
  std::vector<std::uint8_t> complete;  // the point belongs to an owned cell

  explicit Around(const Mesh& mesh) {
    const Index n_points = mesh.points.n_local();
    cells = transpose(mesh.cell_points, 0, n_points);
    faces = transpose(mesh.face_points, mesh.n_interior, n_points);
    complete.assign(n_points, 0);
    for (Index c = 0; c < mesh.cells.n_owned(); ++c)
      for (const Index p : mesh.cell_points[c]) complete[p] = 1;
  }

  /// Rows [first, size) of `rows` by their entries; numbered from 0 at `first`.
  static Csr transpose(const Csr& rows, Index first, Index n_entries) {
    Csr result;
    result.offset.assign(n_entries + 1, 0);
    for (Index i = first; i < rows.size(); ++i)
      for (const Index e : rows[i]) ++result.offset[e + 1];
    for (Index e = 0; e < n_entries; ++e) result.offset[e + 1] += result.offset[e];
    result.index.resize(result.offset.back());
    std::vector<Index> next(result.offset.begin(), result.offset.end() - 1);
    for (Index i = first; i < rows.size(); ++i)
      for (const Index e : rows[i]) result.index[next[e]++] = i - first;
    return result;
  }
};

VertexInterpolation::VertexInterpolation(const Mesh& mesh, std::span<const PatchStencil> stencils)
    : mesh_(&mesh), n_cells_(mesh.cells.n_local()) {
  assert(stencils.size() == mesh.patches.size());
  std::vector<PatchStencil> kind_of_face(mesh.boundary.n_local(), PatchStencil::open);
  for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
    const Patch& patch = mesh.patches[p];
    std::fill_n(kind_of_face.begin() + (patch.first - mesh.n_interior), patch.count, stencils[p]);
    std::fill_n(kind_of_face.begin() + (patch.ghost_first - mesh.n_interior), patch.ghost_count, stencils[p]);
  }
  const Around around(mesh);
  gather_rows(around, kind_of_face);
  find_projectors(around, kind_of_face);
  update(mesh.reference, mesh.reference_points);
}

void VertexInterpolation::gather_rows(const Around& around, std::span<const PatchStencil> kind_of_face) {
  const Index n_points = mesh_->points.n_local();
  fixed_.assign(n_points, 0);
  offset_.assign(1, 0);
  for (Index v = 0; v < n_points; ++v) {
    if (around.complete[v]) {
      const auto faces = around.faces[v];
      fixed_[v] = std::any_of(faces.begin(), faces.end(),
                              [&](Index b) { return kind_of_face[b] == PatchStencil::fixed; });
      const PatchStencil wanted = fixed_[v] ? PatchStencil::fixed : PatchStencil::open;
      if (!fixed_[v]) node_.insert(node_.end(), around.cells[v].begin(), around.cells[v].end());
      for (const Index b : faces)
        if (kind_of_face[b] == wanted) node_.push_back(n_cells_ + b);
    }
    offset_.push_back(static_cast<std::int64_t>(node_.size()));
  }
  weight_.assign(node_.size(), 0);
}

void VertexInterpolation::find_projectors(const Around& around, std::span<const PatchStencil> kind_of_face) {
  const Index n_points = mesh_->points.n_local();
  projector_of_.assign(n_points, 0);
  projectors_.assign(1, Tensor3::Identity());
  for (Index v = 0; v < n_points; ++v) {
    if (!around.complete[v] || fixed_[v]) continue;
    Tensor3 normals = Tensor3::Zero();
    for (const Index b : around.faces[v])
      if (kind_of_face[b] == PatchStencil::symmetry) {
        const Vec3 n = mesh_->reference.face_area[mesh_->n_interior + b].normalized();
        normals += n * n.transpose();
      }
    if (normals.trace() == 0) continue;
    projector_of_[v] = static_cast<Index>(projectors_.size());
    projectors_.push_back(projector_from(normals));
  }
}

void VertexInterpolation::update(const Geometry& geometry, std::span<const Vec3> points) {
  const Index n_points = mesh_->points.n_local(), n_interior = mesh_->n_interior;
  for (Index v = 0; v < n_points; ++v) {
    const auto first = offset_[v], last = offset_[v + 1];
    const bool symmetric = on_symmetry(v);
    const Tensor3& projector = projectors_[projector_of_[v]];
    const auto place = [&](std::int64_t i) -> const Vec3& {
      return node_[i] < n_cells_ ? geometry.cell_centre[node_[i]]
                                 : geometry.face_centre[n_interior + node_[i] - n_cells_];
    };
    // d is the full distance, also at symmetry planes, where r keeps its part within the planes only.
    Tensor3 m = Tensor3::Zero();
    Vec3 s = Vec3::Zero();
    double sum_inverse = 0;
    for (auto i = first; i < last; ++i) {
      Vec3 r = points[v] - place(i);
      const double d = r.norm();
      sum_inverse += 1 / d;
      r /= d;
      if (symmetric) r = projector * r;
      m += r * r.transpose();
      s += r;
    }
    // Across symmetry planes M is filled up with a diagonal: s has no part there, so lambda gets none.
    if (symmetric) m += 0.5 * m.trace() * (Tensor3::Identity() - projector);
    const Vec3 lambda = solve_lambda(m, s, mesh_->dim);
    double sum = 0;
    for (auto i = first; i < last; ++i) {
      const Vec3 r = points[v] - place(i);
      const double d = r.norm();
      weight_[i] = (1 + lambda.dot(r) / d) / d;  // (2.50) with its erratum; lambda lies within the planes
      sum += weight_[i];
    }
    if (std::abs(sum) < reachable * sum_inverse) {
      for (auto i = first; i < last; ++i) weight_[i] = 1 / (points[v] - place(i)).norm();
      sum = sum_inverse;
    }
    for (auto i = first; i < last; ++i) weight_[i] /= sum;
  }
}

}  // namespace couplet
