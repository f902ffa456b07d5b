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

void InnerVariation::add(Index face, const Tensor3& strain) {
  elastic::visit_sides(mesh_, geometry_, face, [&](Index c, double pyramid) {
    energy_[std::size_t(c)] += pyramid * twice_energy(rows_, c, strain);
    strain_[std::size_t(c)] += pyramid * strain;
    volume_[std::size_t(c)] += pyramid;
  });
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

StrainGap strain_gap(const SolidBody& body, std::span<const double> unknowns, std::span<const double> known,
                     Tensor3 (*strain)(const Tensor3&)) {
  const mesh::Mesh& mesh = body.mesh();
  const elastic::ElasticOperator& rows = body.elastic();
  const Index n = mesh.n_flux_faces();
  StrainGap found{.strain = std::vector<Tensor3>(std::size_t(n))};
  InnerVariation variation(mesh, rows);
  double difference = 0, size = 0;
  const auto add = [&](Index f, const Tensor3& e, double& sum) {
    elastic::visit_sides(mesh, body.geometry(), f,
                         [&](Index c, double v) { sum += v * rows.lame(c).mu * e.squaredNorm(); });
  };
  body.kernel().face_gradients(
      unknowns, known,
      [&](Index f, const Tensor3& h) {
        found.strain[std::size_t(f)] = strain(h);
        variation.add(f, found.strain[std::size_t(f)]);
        add(f, found.strain[std::size_t(f)], size);
      },
      0, n);
  elastic::ElasticKernel(
      mesh, rows,
      body.is_corrected() ? elastic::FaceGradientScheme::thesis : elastic::FaceGradientScheme::corrected)
      .face_gradients(
          unknowns, known,
          [&](Index f, const Tensor3& h) { add(f, strain(h) - found.strain[std::size_t(f)], difference); }, 0,
          n);
  size = parallel::sum(mesh.comm, size), difference = parallel::sum(mesh.comm, difference);
  if (size > 0) found.missed = difference / size;
  if (InnerVariation::is_needed(mesh, rows)) found.variation = variation.missed();
  return found;
}

}  // namespace couplet::solid
