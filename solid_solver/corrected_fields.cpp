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

/// Gradients at these flux faces with the known displacements of the accepted time. Collective.
std::vector<Tensor3> Solid::corrected_gradients(Index first, Index count, std::span<const double> cells,
                                                std::span<const double> faces) const {
  std::vector<Tensor3> gradients(mesh_.n_flux_faces());
  kernel_.face_gradients(unknowns_of(cells, faces), known_accepted_, gradients);
  return {gradients.begin() + first, gradients.begin() + first + count};
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
