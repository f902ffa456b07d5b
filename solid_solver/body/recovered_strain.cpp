// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/body/recovered_strain.hpp"

#include <Eigen/Cholesky>
#include <optional>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/mesh/topology.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/body/quadratic_fit.hpp"
#include "solid_solver/body/stress.hpp"

namespace couplet::solid {

namespace {

constexpr GlobalIndex patches_looked_at = 100000;  // of all ranks
constexpr double no_slope = 1e-9;                  // of a slope that no neighbor determines

}  // namespace

RecoveredStrain::RecoveredStrain(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows)
    : mesh_(mesh),
      geometry_(rows.geometry()),
      rows_(rows),
      mean_(std::size_t(mesh.cells.n_local()) * tensor_size, 0.0),
      volume_(std::size_t(mesh.cells.n_local()), 0.0) {}

template <class Visit>
void RecoveredStrain::visit_pyramids(Index face, const Visit& visit) const {
  const auto [here, there] = elastic::pyramids(mesh_, geometry_, face);
  if (mesh_.owner[face] < mesh_.cells.n_owned())
    visit(mesh_.owner[face], Vec3(geometry_.face_centre[face]), here);
  if (face < mesh_.n_interior && mesh_.neighbour[face] < mesh_.cells.n_owned())
    visit(mesh_.neighbour[face], Vec3(geometry_.face_centre[face] - mesh_.shift(face)), there);
}

void RecoveredStrain::add(Index face, const Tensor3& strain) {
  const PackedTensor packed = pack(strain);
  visit_pyramids(face, [&](Index cell, const Vec3&, double volume) {
    volume_[std::size_t(cell)] += volume;
    for (std::size_t i = 0; i < packed.size(); ++i)
      mean_[std::size_t(cell) * tensor_size + i] += volume * packed[i];
  });
}

void RecoveredStrain::recover() {
  stride_ = 1 + mesh_.cells.n_global() / patches_looked_at;
  for (std::size_t c = 0; c < std::size_t(mesh_.cells.n_owned()); ++c)
    for (std::size_t i = 0; i < std::size_t(tensor_size); ++i)
      if (volume_[c] > 0) mean_[c * tensor_size + i] /= volume_[c];
  mesh_.cells.update_ghosts(mean_, tensor_size);
  const mesh::Csr cells_of_point = mesh::transpose(mesh_.cell_points, 0, mesh_.points.n_local());
  std::vector<Index> mark(std::size_t(mesh_.cells.n_local()), -1), patch;
  slot_.assign(std::size_t(mesh_.cells.n_owned()), -1);
  for (Index cell = 0; cell < mesh_.cells.n_owned(); ++cell) {
    if (mesh_.cell_id[cell] % stride_ != 0) continue;  // the same ones on any number of ranks
    patch.clear();
    gather_cells(mesh_, cells_of_point, cell, mark, patch);
    slot_[std::size_t(cell)] = Index(linear_.size());
    linear_.push_back(fit(cell, patch));
  }
  // Frees memory at its peak.
  std::vector<double>().swap(mean_), std::vector<double>().swap(volume_);
}

RecoveredStrain::Linear RecoveredStrain::fit(Index cell, const std::vector<Index>& patch) {
  using Terms = Eigen::Vector4d;
  const Vec3 centre = geometry_.cell_centre[cell];
  Vec3 reach = Vec3::Zero();  // along each axis: thin cells have slopes, too
  for (const Index c : patch) reach = reach.cwiseMax((geometry_.cell_centre[c] - centre).cwiseAbs());
  const double longest = reach.maxCoeff();
  for (int a = 0; a < 3; ++a) reach[a] = reach[a] > no_slope * longest ? 1 / reach[a] : 0;
  if (reach.head(mesh_.dim).minCoeff() == 0) single_ += 1;
  Eigen::Matrix4d of = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, tensor_size> right = Eigen::Matrix<double, 4, tensor_size>::Zero();
  for (const Index c : patch) {
    Terms phi;
    phi << 1, reach.cwiseProduct(geometry_.cell_centre[c] - centre);
    of += phi * phi.transpose();
    right +=
        phi * Eigen::Map<const Eigen::Matrix<double, 1, tensor_size>>(&mean_[std::size_t(c) * tensor_size]);
  }
  of.diagonal().array() += no_slope;
  const Eigen::Matrix<double, 4, tensor_size> coefficients = of.llt().solve(right);
  Linear linear{};
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < tensor_size; ++k)
      linear[std::size_t(i)][std::size_t(k)] = float(coefficients(i, k) * (i == 0 ? 1 : reach[i - 1]));
  return linear;
}

void RecoveredStrain::compare(Index face, const Tensor3& strain) {
  visit_pyramids(face, [&](Index cell, const Vec3&, double volume) {
    if (slot_[std::size_t(cell)] < 0) return;
    const Tensor3 missed = gap(face, cell, strain);
    difference_ += volume * product(cell, missed, missed);
    whole_ += volume * product(cell, strain, strain);
  });
}

Tensor3 RecoveredStrain::gap(Index face, Index cell, const Tensor3& strain) const {
  const Index slot = slot_[std::size_t(cell)];
  if (slot < 0) return Tensor3::Zero();
  const Linear& linear = linear_[std::size_t(slot)];
  Vec3 x = geometry_.face_centre[face] - geometry_.cell_centre[cell];
  if (face < mesh_.n_interior && mesh_.neighbour[face] == cell) x -= mesh_.shift(face);
  PackedTensor gap = pack(strain);
  for (std::size_t k = 0; k < gap.size(); ++k)
    gap[k] -= double(linear[0][k]) + linear[1][k] * x[0] + linear[2][k] * x[1] + linear[3][k] * x[2];
  return unpack(gap);
}

double RecoveredStrain::product(Index cell, const Tensor3& a, const Tensor3& b) const {
  const double whole = contraction(rows_.stress(cell, a), b);
  return rows_.volume_by_cells() ? whole - rows_.lame(cell).lambda * a.trace() * b.trace() : whole;
}

double RecoveredStrain::missed() const {
  const double difference = parallel::sum(mesh_.comm, difference_), whole = parallel::sum(mesh_.comm, whole_);
  return whole > 0 ? difference / whole : 0;
}

bool RecoveredStrain::is_one_row() const {
  return 2 * parallel::sum(mesh_.comm, single_) > parallel::sum(mesh_.comm, double(linear_.size()));
}

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

MissedStrain missed_strain(const SolidBody& body, std::span<const double> unknowns,
                           std::span<const double> known, Tensor3 (*strain)(const Tensor3&), bool recovers) {
  const mesh::Mesh& mesh = body.mesh();
  const Index n = mesh.n_flux_faces();
  std::optional<InnerVariation> variation;
  std::optional<RecoveredStrain> recovered;
  if (InnerVariation::is_needed(mesh, body.elastic())) variation.emplace(mesh, body.elastic());
  if (recovers) recovered.emplace(mesh, body.elastic());
  if (!variation && !recovered) return {};
  body.kernel().face_gradients(
      unknowns, known,
      [&](Index f, const Tensor3& h) {
        const Tensor3 e = strain(h);
        if (variation) variation->add(f, e);
        if (recovered) recovered->add(f, e);
      },
      0, n);
  MissedStrain missed;
  if (variation) missed.variation = variation->missed();
  if (!recovered) return missed;
  recovered->recover();
  body.kernel().face_gradients(
      unknowns, known, [&](Index f, const Tensor3& h) { recovered->compare(f, strain(h)); }, 0, n);
  missed.recovered = recovered->missed();
  missed.is_one_row = recovered->is_one_row();
  return missed;
}

double missed_product(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                      std::span<const Tensor3> a, std::span<const Tensor3> b) {
  RecoveredStrain of_a(mesh, rows), of_b(mesh, rows);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    of_a.add(f, a[std::size_t(f)]);
    of_b.add(f, b[std::size_t(f)]);
  }
  of_a.recover();
  of_b.recover();
  double sum = 0;
  elastic::visit_pyramids(mesh, rows.geometry(), [&](Index c, Index f, double volume) {
    sum += volume * of_a.product(c, of_a.gap(f, c, a[std::size_t(f)]), of_b.gap(f, c, b[std::size_t(f)]));
  });
  return of_a.cells_per_patch() * parallel::sum(mesh.comm, sum);
}

}  // namespace couplet::solid
