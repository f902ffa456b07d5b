// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/body/stress.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

#include "common/parallel/collective.hpp"

namespace couplet::solid {

namespace {

fv::VertexInterpolation::ByFace stencils_of(const mesh::Mesh& mesh, const std::vector<bool>& is_symmetry) {
  fv::VertexInterpolation::ByFace stencils{{}, mesh.cell_material, true};
  for (const Index p : mesh.patch_of_boundary())
    stencils.stencil.push_back(is_symmetry[p] ? fv::PatchStencil::symmetry : fv::PatchStencil::open);
  return stencils;
}

/// Tensors as `size` numbers each, by `numbers(tensor)`, including ghosts.
template <class Numbers>
std::vector<double> with_ghosts(const parallel::IndexMap& map, std::span<const Tensor3> owned, int size,
                                const Numbers& numbers) {
  std::vector<double> values(std::size_t(map.n_local()) * size, 0);
  for (std::size_t i = 0; i < owned.size(); ++i)
    std::ranges::copy(numbers(owned[i]), values.begin() + std::ptrdiff_t(i) * size);
  map.update_ghosts(values, size);
  return values;
}

}  // namespace

PackedTensor pack(const Tensor3& t) { return {t(0, 0), t(1, 1), t(2, 2), t(0, 1), t(1, 2), t(0, 2)}; }

Tensor3 unpack(std::span<const double> p) {
  Tensor3 t;
  t << p[0], p[3], p[5], p[3], p[1], p[4], p[5], p[4], p[2];
  return t;
}

int number_of_materials(const mesh::Mesh& mesh) {
  const auto last = std::ranges::max_element(mesh.cell_material);
  return 1 + int(parallel::max(mesh.comm, last == mesh.cell_material.end() ? 0 : *last));
}

double equivalent_stress(const Tensor3& s) {
  const Tensor3 deviator = s - s.trace() / 3 * Tensor3::Identity();
  return std::sqrt(1.5 * deviator.squaredNorm());
}

std::vector<double> worst_side(SidedTensors sides) {
  constexpr double more =
      1 + 1e-6;  // sides that round-off alone tells apart: the first, on any number of ranks
  std::vector<double> worst = std::move(sides.front());
  for (std::size_t m = 1; m < sides.size(); ++m)
    for (std::size_t i = 0; i < worst.size(); i += tensor_size) {
      const std::span<const double> here = std::span(sides[m]).subspan(i, tensor_size);
      const std::span<double> most = std::span(worst).subspan(i, tensor_size);
      if (std::isnan(here[0])) continue;
      if (std::isnan(most[0]) || equivalent_stress(unpack(here)) > more * equivalent_stress(unpack(most)))
        std::ranges::copy(here, most.begin());
    }
  return worst;
}

std::array<double, 3> principal_stresses(const Tensor3& stress) {
  const Vec3 values = Eigen::SelfAdjointEigenSolver<Tensor3>(stress, Eigen::EigenvaluesOnly).eigenvalues();
  return {values[2], values[1], values[0]};
}

PointTensors::PointTensors(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                           const std::vector<bool>& is_symmetry, const fv::VertexInterpolation& inside)
    : mesh_(&mesh), inside_(&inside), surface_(mesh, geometry, stencils_of(mesh, is_symmetry)) {
  for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
    if (!is_symmetry[p]) continue;
    const mesh::Patch& patch = mesh.patches[p];
    Vec3 area = Vec3::Zero();
    Mirror mirror;
    const auto take = [&](Index first, Index count) {
      for (Index f = first; f < first + count; ++f)
        for (const Index v : mesh.face_points[f]) mirror.points.push_back(v);
    };
    for (Index f = patch.first; f < patch.first + patch.count; ++f) area += geometry.face_area[f];
    take(patch.first, patch.count);
    take(patch.ghost_first, patch.ghost_count);
    std::ranges::sort(mirror.points);
    mirror.points.erase(std::ranges::unique(mirror.points).begin(), mirror.points.end());
    for (int a = 0; a < 3; ++a) area[a] = parallel::sum(mesh.comm, area[a]);
    const Vec3 n = area.normalized();
    mirror.reflection = Tensor3::Identity() - 2 * n * n.transpose();
    mirrors_.push_back(std::move(mirror));
  }
}

SidedTensors PointTensors::interpolate(std::span<const Tensor3> cells, std::span<const Tensor3> faces) const {
  const std::vector<double> in_cells = with_ghosts(mesh_->cells, cells, tensor_size, pack);
  const std::vector<double> on_faces = with_ghosts(mesh_->boundary, faces, tensor_size, pack);
  SidedTensors sides;
  for (int m = 0; m < number_of_materials(*mesh_); ++m) {
    std::vector<double>& values = sides.emplace_back(std::size_t(mesh_->points.n_local()) * tensor_size);
    const auto at = [&](Index v) { return values.data() + std::size_t(v) * tensor_size; };
    for (Index v = 0; v < mesh_->points.n_local(); ++v)
      Eigen::Map<Vec<tensor_size>>(at(v)) = mesh_->cell_material.empty()
                                                ? row_of(v).scalar_at<tensor_size>(v, in_cells, on_faces)
                                                : side_of(v, m, in_cells, on_faces);
    // Averages with the mirror images at symmetry planes.
    for (const Mirror& mirror : mirrors_)
      for (const Index v : mirror.points) {
        const Tensor3 tensor = unpack({at(v), tensor_size});
        std::ranges::copy(pack(0.5 * (tensor + mirror.reflection * tensor * mirror.reflection)), at(v));
      }
    mesh_->points.update_ghosts(values, tensor_size);
  }
  return sides;
}

/// Mean over the nodes of one material by their weights, which are exact for linear fields of each.
Vec<tensor_size> PointTensors::side_of(Index point, int material, std::span<const double> cells,
                                       std::span<const double> faces) const {
  const auto nodes = row_of(point).nodes(point);
  const auto weights = row_of(point).weights(point);
  Vec<tensor_size> sum = Vec<tensor_size>::Zero();
  double whole = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Index face = nodes[i] - mesh_->cells.n_local();
    const Index cell = face < 0 ? nodes[i] : mesh_->owner[mesh_->n_interior + face];
    if (mesh_->material_of(cell) != material) continue;
    const double* node = face < 0 ? cells.data() + std::size_t(cell) * tensor_size
                                  : faces.data() + std::size_t(face) * tensor_size;
    sum += weights[i] * Eigen::Map<const Vec<tensor_size>>(node);
    whole += weights[i];
  }
  return sum / whole;
}

}  // namespace couplet::solid
