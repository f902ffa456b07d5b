// SPDX-License-Identifier: Apache-2.0
// Gradients of the displacement in cells, from which stress and strain follow.
#include <cmath>

#include "common/fv/point_gradient.hpp"
#include "solid_solver/body/solid_fields.hpp"

namespace couplet::solid {
namespace {

/// Cells all of whose neighbours by vertex are of the same kind and material. Elsewhere the values at points
/// are less exact (kind) or have no one gradient (material).
std::vector<bool> uniform_surroundings(const mesh::Mesh& mesh) {
  constexpr int unseen = -1, several = -2;
  std::vector<int> around(mesh.points.n_local(), unseen);
  for (Index c = 0; c < mesh.cells.n_local(); ++c) {
    const int here = static_cast<int>(mesh.cell_type[c]) + 16 * mesh.material_of(c);
    for (const Index v : mesh.cell_points[c])
      around[v] = around[v] == unseen || around[v] == here ? here : several;
  }
  std::vector<bool> uniform(mesh.cells.n_owned(), true);
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    for (const Index v : mesh.cell_points[c]) uniform[c] = uniform[c] && around[v] != several;
  return uniform;
}

}  // namespace

/// Mean of the face gradients by the pyramids over the faces: exact for fields whose gradient is linear if
/// those of the faces are. With the corrected face gradient the points' values are exact for quadratics, and
/// Gauss's theorem over the faces with these means at the points errs by h^2/24 of the third derivatives
/// along a line of cells where the mean of the faces' differences errs by h^2/6.
std::vector<Tensor3> SolidFields::cell_gradient(std::span<const double> points) const {
  const Index n_owned = mesh_.cells.n_owned();
  std::vector<Tensor3> gradient(n_owned, Tensor3::Zero()), on_boundary;
  std::vector<double> weight(n_owned, 0);
  if (body_.is_corrected()) on_boundary.resize(mesh_.boundary.n_owned());
  body_.visit_gradients(displacement(points), [&](Index f, const Tensor3& here) {
    const auto add = [&](Index c) {
      if (c >= n_owned) return;
      const Vec3 arm = geometry_.face_centre[f] - geometry_.cell_centre[c];
      const double pyramid = std::abs(arm.dot(geometry_.face_area[f]));
      gradient[c] += pyramid * here;
      weight[c] += pyramid;
    };
    add(mesh_.owner[f]);
    if (f < mesh_.n_interior)
      add(mesh_.neighbour[f]);
    else if (body_.is_corrected())
      on_boundary[f - mesh_.n_interior] = here;
  });
  for (Index c = 0; c < n_owned; ++c) gradient[c] /= weight[c];
  weight = std::vector<double>();
  if (!body_.is_corrected()) return gradient;

  const std::vector<Tensor3> at_points = point_tensors().interpolate_full(gradient, on_boundary);
  const std::vector<Tensor3> better = fv::gradients_from_points(mesh_, geometry_, points, at_points);
  const std::vector<bool> uniform = uniform_surroundings(mesh_);
  for (Index c = 0; c < n_owned; ++c)
    if (uniform[c]) gradient[c] = better[c];
  return gradient;
}

}  // namespace couplet::solid
