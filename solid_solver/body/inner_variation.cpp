// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/body/inner_variation.hpp"

#include <algorithm>

#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {
namespace {

double twice_energy(const elastic::ElasticOperator& rows, Index cell, const Tensor3& strain) {
  return contraction(rows.stress(cell, strain), strain);
}

}  // namespace

InnerVariation::InnerVariation(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows)
    : mesh_(mesh),
      geometry_(rows.geometry()),
      rows_(rows),
      energy_(std::size_t(mesh.cells.n_owned()), 0),
      strain_(energy_.size(), Tensor3::Zero()),
      volume_(energy_.size(), 0) {}

bool InnerVariation::is_needed(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows) {
  return mesh.dim == 2 && !rows.volume_by_cells();
}

void InnerVariation::add_to(Index cell, double volume, const Tensor3& strain) {
  energy_[std::size_t(cell)] += volume * twice_energy(rows_, cell, strain);
  strain_[std::size_t(cell)] += volume * strain;
  volume_[std::size_t(cell)] += volume;
}

void InnerVariation::add(Index face, const Tensor3& strain) {
  const auto [here, there] = elastic::pyramids(mesh_, geometry_, face);
  if (mesh_.owner[face] < mesh_.cells.n_owned()) add_to(mesh_.owner[face], here, strain);
  if (face < mesh_.n_interior && mesh_.neighbour[face] < mesh_.cells.n_owned())
    add_to(mesh_.neighbour[face], there, strain);
}

double InnerVariation::energy() const {
  double missed = 0;
  for (std::size_t c = 0; c < energy_.size(); ++c)
    if (mesh_.cell_type[c] == mesh::CellType::quadrilateral && volume_[c] > 0)
      missed +=
          (energy_[c] - volume_[c] * twice_energy(rows_, static_cast<Index>(c), strain_[c] / volume_[c])) / 3;
  return parallel::sum(mesh_.comm, missed);
}

double InnerVariation::missed() const {
  double missed = 0, whole = 0;
  for (std::size_t c = 0; c < energy_.size(); ++c) {
    whole += energy_[c];
    if (mesh_.cell_type[c] != mesh::CellType::quadrilateral || !(volume_[c] > 0)) continue;
    const Tensor3 mean = strain_[c] / volume_[c];
    missed += std::max(0.0, energy_[c] - volume_[c] * twice_energy(rows_, static_cast<Index>(c), mean)) / 3;
  }
  missed = parallel::sum(mesh_.comm, missed), whole = parallel::sum(mesh_.comm, whole);
  return whole > 0 ? missed / whole : 0;
}

}  // namespace couplet::solid
