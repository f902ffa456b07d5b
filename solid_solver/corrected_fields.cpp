// SPDX-License-Identifier: Apache-2.0
// Displacements at points and gradients at faces with the corrected face gradient.
#include <algorithm>

#include "solid_solver/solid.hpp"

namespace couplet {

/// The unknowns of elastic() in these fields.
std::vector<double> Solid::unknowns_of(std::span<const double> cells, std::span<const double> faces) const {
  const std::size_t dim = mesh_.dim, n_cells = mesh_.cells.n_owned() * dim;
  std::vector<double> unknowns(cells.begin(), cells.begin() + std::ptrdiff_t(n_cells));
  for (const Index f : elastic_.unknown_faces()) {
    const auto first = faces.begin() + std::ptrdiff_t((f - mesh_.n_interior) * dim);
    unknowns.insert(unknowns.end(), first, first + std::ptrdiff_t(dim));
  }
  return unknowns;
}

/// The known columns of elastic() in these fields: what of a point's value is not free, and the known faces.
std::vector<double> Solid::known_of(std::span<const double> faces, std::span<const double> points) const {
  const int dim = mesh_.dim;
  const VertexConstraints& constraints = elastic_.constraints();
  std::vector<double> known(elastic_.n_known() * dim, 0);
  const auto at = [dim](std::span<const double> values, Index i) {
    Vec3 u = Vec3::Zero();
    for (int a = 0; a < dim; ++a) u[a] = values[std::size_t(i) * dim + a];
    return u;
  };
  for (const Index v : constraints.points()) {
    const Vec3 u = at(points, v), held = u - constraints.free_part(v) * u;
    for (int a = 0; a < dim; ++a) known[std::size_t(constraints.column(v)) * dim + a] = held[a];
  }
  for (const Index f : elastic_.known_faces()) {
    const Vec3 u = at(faces, f - mesh_.n_interior);
    for (int a = 0; a < dim; ++a) known[std::size_t(elastic_.known_of_face(f)) * dim + a] = u[a];
  }
  return known;
}

/// Values of all local points. Collective.
std::vector<double> Solid::corrected_points(std::span<const double> cells, std::span<const double> faces,
                                            std::span<const double> known) const {
  std::vector<double> values(std::size_t(mesh_.points.n_local()) * mesh_.dim, 0);
  kernel_.point_values(unknowns_of(cells, faces), known, values);
  mesh_.points.update_ghosts(values, mesh_.dim);
  return values;
}

}  // namespace couplet
