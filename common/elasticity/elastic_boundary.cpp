// SPDX-License-Identifier: Apache-2.0

#include "common/elasticity/elastic_boundary.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "common/mesh/topology.hpp"

namespace couplet::elastic {

BoundaryRow free_row() { return {}; }

BoundaryRow fixed_row() { return support_row(Tensor3::Identity(), Tensor3::Zero()); }

BoundaryRow support_row(const Tensor3& known, const Tensor3& spring) {
  BoundaryRow row;
  row.known = row.transmitted = known;
  row.spring = spring;
  row.fixed = known == Tensor3::Identity();
  row.held = !known.isZero(0);
  return row;
}

BoundaryRow mirror_row() {
  BoundaryRow row;
  row.held = row.mirrored = true;
  return row;
}

BoundaryRow level_row() {
  BoundaryRow row;
  row.transmitted = Tensor3::Identity();
  row.level = true;
  return row;
}

void ElasticBoundary::add(const BoundaryRow& row) {
  if (rows_.empty() || !(rows_.back() == row)) rows_.push_back(row);
  row_of_face_.push_back(static_cast<Index>(rows_.size()) - 1);
}

ElasticBoundary ElasticBoundary::on(const mesh::Mesh& mesh, const mesh::Geometry& geometry) const {
  ElasticBoundary result;
  const std::vector<Index> patch_of = mesh.patch_of_boundary();
  for (Index b = 0; b < size(); ++b) {
    BoundaryRow row = (*this)[b];
    if (mesh.patches[patch_of[b]].bonded) {
      row = {};
      row.transmitted = Tensor3::Identity();
      row.shared = true;
    }
    if (row.mirrored) {
      const Vec3 n = geometry.face_area[mesh.n_interior + b].normalized();
      row.known = row.transmitted = n * n.transpose();
    }
    result.add(row);
  }
  return result;
}

ElasticBoundary boundary_of_patches(const mesh::Mesh& mesh, std::span<const BoundaryRow> of_patches) {
  ElasticBoundary boundary;
  for (const Index p : mesh.patch_of_boundary()) boundary.add(of_patches[p]);
  return boundary;
}

namespace {

// Minimum share of a patch's faces around a vertex that must know a direction.
constexpr double agreed = 0.75;
// A direction is already known if its remaining part is shorter than this (0.06 degrees).
constexpr double new_direction = 1e-3;

/// Eigenvectors of a symmetric tensor with eigenvalues above the threshold, largest first.
std::vector<Vec3> directions_above(const Tensor3& tensor, double threshold) {
  const Eigen::SelfAdjointEigenSolver<Tensor3> eigen(tensor);
  std::vector<Vec3> result;
  for (int i = 2; i >= 0; --i)
    if (eigen.eigenvalues()[i] > threshold) result.push_back(eigen.eigenvectors().col(i));
  return result;
}

}  // namespace

/// Projector Q and shares G_j of one vertex under construction.
class VertexConstraints::Known {
 public:
  /// Adds b . u = b . g_face for a unit vector b, or g = 0 if face < 0. With the part r of b outside the
  /// known directions, r . u = b . (g_face - g so far). Returns false if b was known already.
  bool add(const Vec3& b, Index face) {
    const Vec3 across = b - q * b;
    const double size = across.norm();
    if (size < new_direction) return false;
    const Tensor3 solve = across / (size * size) * b.transpose();
    for (Source& s : sources) s.share -= solve * s.share;
    if (face >= 0) {
      const auto same = std::ranges::find(sources, face, &Source::face);
      if (same != sources.end())
        same->share += solve;
      else
        sources.push_back({face, solve});
    }
    q += across * across.transpose() / (size * size);
    return true;
  }

  Tensor3 q = Tensor3::Zero();
  std::vector<Source> sources;
};

VertexConstraints::VertexConstraints(const mesh::Mesh& mesh, const ElasticBoundary& boundary,
                                     const fv::VertexInterpolation& vertices) {
  const Index n_points = mesh.points.n_local();
  const mesh::Csr faces = mesh::transpose(mesh.face_points, mesh.n_interior, n_points);
  const std::vector<Index> patch_of_face = mesh.patch_of_boundary();
  std::vector<std::uint8_t> complete(n_points, 0);
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    for (const Index v : mesh.cell_points[c]) complete[v] = 1;
  free_of_.assign(n_points, 0);
  column_.assign(n_points, -1);
  for (Index v = 0; v < n_points; ++v)
    if (complete[v] && faces[v].size() > 0)
      constrain(v, faces[v], mesh, boundary, patch_of_face, vertices.projector(v));
}

void VertexConstraints::constrain(Index point, std::span<const Index> faces, const mesh::Mesh& mesh,
                                  const ElasticBoundary& boundary, std::span<const Index> patch_of_face,
                                  const Tensor3& symmetry) {
  // Sorts by patch, then by the number in the mesh file: the same order on every rank.
  std::vector<Index> ordered(faces.begin(), faces.end());
  std::ranges::sort(ordered, {}, [&](Index b) { return std::pair(patch_of_face[b], mesh.boundary_id[b]); });
  Known known;
  if (mesh.dim == 2) known.q(2, 2) = 1;
  for (const Index b : ordered)
    if (boundary[b].fixed && known.sources.empty()) {
      known.q = Tensor3::Identity();
      known.sources.push_back({b, Tensor3::Identity()});
    } else if (boundary[b].fixed) {
      repeated_.push_back({point, b, Tensor3::Identity()});
    }
  for (auto first = ordered.begin(); first != ordered.end();) {
    const auto last = std::find_if(first, ordered.end(),
                                   [&](Index b) { return patch_of_face[b] != patch_of_face[*first]; });
    Tensor3 mean = Tensor3::Zero();
    Index source = -1;
    double most = 0;
    for (auto b = first; b != last; ++b) {
      if (!boundary[*b].held || boundary[*b].mirrored) continue;
      const Tensor3& p = boundary[*b].known;
      mean += p / double(last - first);
      if (p.trace() > most + 0.5) source = *b, most = p.trace();
    }
    if (source >= 0)
      for (const Vec3& b : directions_above(mean, agreed))
        if (!known.add(b, source)) repeated_.push_back({point, source, b * b.transpose()});
    first = last;
  }
  for (const Index b : ordered)
    if (const Tensor3& across = boundary[b].known;
        boundary[b].mirrored && (across - known.q * across).norm() < new_direction)
      repeated_.push_back({point, b, across});
  for (const Vec3& n : directions_above(Tensor3::Identity() - symmetry, 0.5)) known.add(n, -1);
  if (known.q.trace() > (mesh.dim == 2 ? 1.5 : 0.5)) store(point, known);
}

void VertexConstraints::store(Index point, const Known& known) {
  const Tensor3 free = Tensor3::Identity() - known.q;
  if (free.norm() < 1e-6) {
    free_of_[point] = 1;
  } else {
    free_of_[point] = static_cast<Index>(free_parts_.size());
    free_parts_.push_back(free);
  }
  if (known.sources.empty()) return;
  column_[point] = static_cast<Index>(points_.size());
  points_.push_back(point);
  sources_.insert(sources_.end(), known.sources.begin(), known.sources.end());
  offset_.push_back(static_cast<Index>(sources_.size()));
}

}  // namespace couplet::elastic
