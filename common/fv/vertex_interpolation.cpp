// SPDX-License-Identifier: Apache-2.0
#include "common/fv/vertex_interpolation.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/mesh/topology.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fv {

mesh::Csr flux_faces_of_cells(const mesh::Mesh& mesh) {
  const Index n = mesh.cells.n_owned();
  mesh::Csr result;
  result.offset.assign(n + 1, 0);
  const auto visit = [&](auto&& take) {
    for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
      if (mesh.owner[f] < n) take(mesh.owner[f], f);
      if (f < mesh.n_interior && mesh.neighbour[f] < n) take(mesh.neighbour[f], f);
    }
  };
  visit([&](Index c, Index) { ++result.offset[c + 1]; });
  for (Index c = 0; c < n; ++c) result.offset[c + 1] += result.offset[c];
  result.index.resize(result.offset.back());
  std::vector<Index> next(result.offset.begin(), result.offset.end() - 1);
  visit([&](Index c, Index f) { result.index[next[c]++] = f; });
  return result;
}

std::vector<GlobalIndex> number_nodes(const mesh::Mesh& mesh, std::span<const Index> faces_with_unknown) {
  const Index n_owned = mesh.cells.n_owned();
  const GlobalIndex first =
      parallel::exclusive_scan(mesh.comm, GlobalIndex(n_owned) + std::ssize(faces_with_unknown));
  std::vector<GlobalIndex> number(mesh.cells.n_local(), -1), boundary(mesh.boundary.n_local(), -1);
  for (Index c = 0; c < n_owned; ++c) number[c] = first + c;
  for (std::size_t i = 0; i < faces_with_unknown.size(); ++i)
    boundary[faces_with_unknown[i] - mesh.n_interior] = first + n_owned + static_cast<GlobalIndex>(i);
  mesh.cells.update_ghosts(std::span<GlobalIndex>(number));
  mesh.boundary.update_ghosts(std::span<GlobalIndex>(boundary));
  for (std::size_t b = 0; b < mesh.twin.size(); ++b)
    if (mesh.twin[b] >= 0 && boundary[b] < 0) boundary[b] = boundary[mesh.twin[b]];
  number.insert(number.end(), boundary.begin(), boundary.end());
  return number;
}

namespace {

// Relative eigenvalue of sum r r^T below which nodes do not span a direction (r are unit vectors, so a cell
// of aspect ratio 1e5 still spans it).
constexpr double spanned = 1e-12;
// Relative cancellation of the weights (to sum 1/d) at which no weighted mean of the nodes reaches the point.
constexpr double reachable = 1e-8;
// Relative distance of the weighted mean from the point above which linear fields are not exact.
constexpr double exact = 1e-6;

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

}  // namespace

Vec3 VertexSums::lambda(int dim, const Tensor3* within) const {
  if (!within) return solve_lambda(m, s, dim);
  // Adds a diagonal across symmetry planes, where s and therefore lambda vanish.
  return solve_lambda(m + 0.5 * m.trace() * (Tensor3::Identity() - *within), s, dim);
}

bool VertexWeightSums::cancels(const VertexSums& nodes) const {
  return std::abs(sum) < reachable * nodes.inverse_distance;
}

bool VertexWeightSums::meets(const VertexSums& nodes, const Tensor3* within) const {
  // inverse_distance / count is the mean inverse distance of the nodes.
  const double off = within ? (*within * miss).norm() : miss.norm();
  return off * nodes.inverse_distance <= exact * nodes.count * std::abs(sum);
}

namespace {

// Eigenvalue ratios of the mean of n n^T over symmetry faces of a patch at a vertex, tan^2 of half the angle
// between two normals. Below the first (1 degree) the faces form one plane, above the second (40 degrees)
// two.
constexpr double one_plane = 1e-4, two_planes = 0.13;
// Planes of different patches with normals closer than this (0.06 degrees) are one plane.
constexpr double new_direction = 1e-3;

VertexInterpolation::ByFace by_face(const mesh::Mesh& mesh, std::span<const PatchStencil> stencils) {
  assert(stencils.size() == mesh.patches.size());
  VertexInterpolation::ByFace result;
  for (const Index p : mesh.patch_of_boundary()) result.stencil.push_back(stencils[p]);
  return result;
}

/// Normals of one symmetry patch at a vertex, from the mean of n n^T.
struct Planes {
  std::vector<Vec3> normals;
  bool bent = false;  // neither flat nor an edge
};

Planes planes_of(const Tensor3& mean) {
  const Eigen::SelfAdjointEigenSolver<Tensor3> eigen(mean);
  Planes planes{{eigen.eigenvectors().col(2)}};
  for (int i = 1; i >= 0; --i) {
    const double ratio = eigen.eigenvalues()[i] / eigen.eigenvalues()[2];
    if (ratio > two_planes) planes.normals.push_back(eigen.eigenvectors().col(i));
    planes.bent = planes.bent || (ratio > one_plane && ratio <= two_planes);
  }
  return planes;
}

/// Removes the direction n from a projector.
void take_away(const Vec3& n, Tensor3& projector) {
  const Vec3 across = projector * n;
  if (across.norm() < new_direction) return;
  projector -= across * across.transpose() / across.squaredNorm();
}

}  // namespace

/// Cells and boundary faces (entries of mesh.boundary) around each point.
struct VertexInterpolation::Around {
  mesh::Csr cells, faces;
  std::vector<std::uint8_t> complete;  // the point belongs to an owned cell

  explicit Around(const mesh::Mesh& mesh) {
    const Index n_points = mesh.points.n_local();
    cells = mesh::transpose(mesh.cell_points, 0, n_points);
    faces = mesh::transpose(mesh.face_points, mesh.n_interior, n_points);
    complete.assign(n_points, 0);
    for (Index c = 0; c < mesh.cells.n_owned(); ++c)
      for (const Index p : mesh.cell_points[c]) complete[p] = 1;
  }
};

VertexInterpolation::VertexInterpolation(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                         std::span<const PatchStencil> stencils)
    : VertexInterpolation(mesh, geometry, by_face(mesh, stencils)) {}

VertexInterpolation::VertexInterpolation(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                         const ByFace& boundary)
    : mesh_(&mesh), n_cells_(mesh.cells.n_local()) {
  assert(Index(boundary.stencil.size()) == mesh.boundary.n_local());
  const Around around(mesh);
  gather_rows(around, boundary);
  find_projectors(around, geometry, boundary.stencil);
  update(geometry);
}

void VertexInterpolation::gather_rows(const Around& around, const ByFace& boundary) {
  const Index n_points = mesh_->points.n_local();
  fixed_.assign(n_points, 0);
  offset_.reserve(n_points + 1);
  offset_.assign(1, 0);
  if (!boundary.material_of_cell.empty()) ends_first_.assign(n_points, -1);
  for (Index v = 0; v < n_points; ++v) {
    if (around.complete[v] && (!boundary.surface_only || !around.faces[v].empty())) {
      const bool wide = mesh_->is_wide(v);
      const auto faces = around.faces[v];
      fixed_[v] = std::any_of(faces.begin(), faces.end(),
                              [&](Index b) { return boundary.stencil[b] == PatchStencil::fixed; });
      const PatchStencil wanted = fixed_[v] ? PatchStencil::fixed : PatchStencil::open;
      if (wide && !fixed_[v]) {
        gather_wide_row(v, around, boundary);
      } else {
        if (!fixed_[v]) node_.insert(node_.end(), around.cells[v].begin(), around.cells[v].end());
        for (const Index b : faces)
          if (boundary.stencil[b] == wanted) node_.push_back(n_cells_ + b);
      }
      if (!boundary.material_of_cell.empty() && !fixed_[v]) group_by_material(v, boundary.material_of_cell);
    }
    offset_.push_back(static_cast<std::int64_t>(node_.size()));
  }
  node_.shrink_to_fit();
  weight_.assign(node_.size(), 0);
}

/// Collects the nodes around all points of the cells at this point, of the materials that meet here.
void VertexInterpolation::gather_wide_row(Index point, const Around& around, const ByFace& boundary) {
  const std::span<const int> material = boundary.material_of_cell;
  const auto cells = around.cells[point];
  const auto take = [&](Index node, Index cell) {
    if (material.empty() ||
        std::ranges::any_of(cells, [&](Index c) { return material[c] == material[cell]; }))
      node_.push_back(node);
  };
  for (const Index c : cells)
    for (const Index p : mesh_->cell_points[c]) {
      for (const Index other : around.cells[p]) take(other, other);
      for (const Index b : around.faces[p])
        if (boundary.stencil[b] == PatchStencil::open)
          take(n_cells_ + b, mesh_->owner[mesh_->n_interior + b]);
    }
  const auto first = node_.begin() + offset_.back();
  std::sort(first, node_.end());
  node_.erase(std::unique(first, node_.end()), node_.end());
}

/// Sorts the nodes of the current row by material and records the end of each.
void VertexInterpolation::group_by_material(Index point, std::span<const int> material_of_cell) {
  const auto material = [&](Index node) {
    return material_of_cell[node < n_cells_ ? node : mesh_->owner[mesh_->n_interior + node - n_cells_]];
  };
  const auto first = node_.begin() + offset_.back();
  std::stable_sort(first, node_.end(), [&](Index a, Index b) { return material(a) < material(b); });
  if (first == node_.end() || material(*first) == material(node_.back())) return;
  ends_first_[point] = static_cast<Index>(ends_.size());
  for (auto i = first + 1; i != node_.end(); ++i)
    if (material(*i) != material(*(i - 1))) ends_.push_back(i - node_.begin());
  ends_.push_back(std::ssize(node_));
}

void VertexInterpolation::find_projectors(const Around& around, const mesh::Geometry& geometry,
                                          std::span<const PatchStencil> stencil) {
  const Index n_points = mesh_->points.n_local();
  projector_of_.assign(n_points, 0);
  projectors_.assign(1, Tensor3::Identity());
  if (std::ranges::count(stencil, PatchStencil::symmetry) == 0) return;
  const std::vector<Index> patch_of_face = mesh_->patch_of_boundary();
  for (Index v = 0; v < n_points; ++v) {
    if (!around.complete[v] || fixed_[v]) continue;
    Tensor3 projector = Tensor3::Identity();
    for (std::size_t p = 0; p < mesh_->patches.size(); ++p) {
      Tensor3 mean = Tensor3::Zero();
      for (const Index b : around.faces[v]) {
        if (stencil[b] != PatchStencil::symmetry || patch_of_face[b] != Index(p)) continue;
        const Vec3 n = geometry.face_area[mesh_->n_interior + b].normalized();
        mean += n * n.transpose();
      }
      if (mean.trace() == 0) continue;
      const Planes planes = planes_of(mean);
      if (planes.bent) bent_.push_back(v);
      for (const Vec3& n : planes.normals) take_away(n, projector);
    }
    if (projector.trace() > 2.5) continue;
    projector_of_[v] = static_cast<Index>(projectors_.size());
    projectors_.push_back(projector);
  }
}

void VertexInterpolation::update(const mesh::Geometry& geometry) {
  const std::vector<Vec3>& points = geometry.points;
  inexact_.clear();
  for (Index v = 0; v < mesh_->points.n_local(); ++v) {
    const auto first = offset_[v], last = offset_[v + 1];
    bool exact_here = true;
    if (ends_first_.empty() || ends_first_[v] < 0) {
      exact_here = find_weights(v, first, last, geometry, points[v]);
    } else {
      int n_materials = 0;
      auto begin = first;
      for (auto end = ends_.begin() + ends_first_[v]; begin != last; begin = *end++, ++n_materials)
        exact_here = find_weights(v, begin, *end, geometry, points[v]) && exact_here;
      for (auto i = first; i < last; ++i) weight_[i] /= n_materials;
    }
    if (!exact_here && !fixed_[v] && v < mesh_->points.n_owned()) inexact_.push_back(v);
  }
}

/// Computes normalized weights of the nodes [first, last) of a row. Returns true if they are exact for linear
/// fields.
bool VertexInterpolation::find_weights(Index point, std::int64_t first, std::int64_t last,
                                       const mesh::Geometry& geometry, const Vec3& at) {
  // Unit-vector weights may cancel. Least-squares weights are the smallest possible.
  if (!mesh_->is_wide(point)) {
    const bool is_exact = fill_weights(point, first, last, geometry, at, false);
    if (magnification({weight_.data() + first, std::size_t(last - first)}) <= mesh::longest_reach)
      return is_exact;
  }
  return fill_weights(point, first, last, geometry, at, true);
}

/// `least_squares` scales lambda by the nodes' distances, which gives the smallest possible weights.
bool VertexInterpolation::fill_weights(Index point, std::int64_t first, std::int64_t last,
                                       const mesh::Geometry& geometry, const Vec3& at, bool least_squares) {
  const VertexWeights kind = least_squares ? VertexWeights::least_squares : VertexWeights::inverse_distance;
  const Tensor3* within = on_symmetry(point) ? &projector(point) : nullptr;
  const auto from = [&](std::int64_t i) -> Vec3 {
    return at - (node_[i] < n_cells_ ? geometry.cell_centre[node_[i]]
                                     : geometry.face_centre[mesh_->n_interior + node_[i] - n_cells_]);
  };
  // d is the full distance, even at symmetry planes, where r only keeps its in-plane part.
  VertexSums nodes;
  for (auto i = first; i < last; ++i) nodes.add(from(i), kind, within);
  const Vec3 lambda = nodes.lambda(mesh_->dim, within);
  VertexWeightSums all;
  for (auto i = first; i < last; ++i) {
    // (2.50) with its erratum; lambda lies in the planes.
    weight_[i] = vertex_weight(from(i), lambda, kind);
    all.add(weight_[i], from(i));
  }
  const bool cancels = all.cancels(nodes);
  if (cancels)
    for (auto i = first; i < last; ++i) weight_[i] = 1 / from(i).norm();
  for (auto i = first; i < last; ++i) weight_[i] /= cancels ? nodes.inverse_distance : all.sum;
  return !cancels && all.meets(nodes, within);
}

}  // namespace couplet::fv
