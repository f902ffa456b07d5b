// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/large_strain/large_strain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/fv/gradients.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {
namespace {

// Of a stiffness, in a residual that is nothing but rounding.
constexpr double last_digits = 2e-15;

}  // namespace

double rounding_of_forces(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows) {
  const mesh::Geometry& geometry = rows.geometry();
  double square = 0;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] >= mesh.cells.n_owned()) continue;
    const elastic::LameConstants lame = rows.lame(mesh.owner[f]);
    const double force = (2 * lame.mu + lame.lambda) * geometry.face_area[f].norm();
    square += 2 * force * force;
  }
  return last_digits * std::sqrt(parallel::sum(mesh.comm, square));
}

double rounding_of_motion(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows) {
  const mesh::Geometry& geometry = rows.geometry();
  double square = 0;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] >= mesh.cells.n_owned()) continue;
    const elastic::LameConstants lame = rows.lame(mesh.owner[f]);
    const fv::FaceLine line = fv::face_line(mesh, geometry, f);
    const double stiffness = (2 * lame.mu + lame.lambda) * line.area * line.inverse_dn;
    square += 2 * stiffness * stiffness;
  }
  return std::numeric_limits<double>::epsilon() * std::sqrt(parallel::sum(mesh.comm, square));
}

std::string worst_cell(const mesh::Mesh& mesh, const mesh::Geometry& geometry, double ratio, Index face) {
  struct Place {
    double ratio, x[3];
  };
  Place here{ratio, {0, 0, 0}};
  if (face >= 0)
    for (int a = 0; a < 3; ++a) here.x[a] = geometry.cell_centre[mesh.owner[face]][a];
  const std::vector<Place> all = parallel::all_gather(mesh.comm, std::vector<Place>{here});
  const Place& w = *std::ranges::min_element(all, {}, &Place::ratio);
  if (!(w.ratio < 1)) return "No cell is compressed.";
  return fmt::format("The worst cell is at ({:.4g}, {:.4g}, {:.4g}) m (undeformed), where det F = {:.3g}.",
                     w.x[0], w.x[1], w.x[2], w.ratio);
}

// Strain and Cauchy's stress at large strain.

/// Green's (F^T F - I) / 2.
void LargeStrain::to_strain(std::span<Tensor3> gradients) const {
  for (Tensor3& g : gradients) g = (0.5 * (g + g.transpose()) + 0.5 * g * g.transpose()).eval();
}

/// sigma = P F^T / J.
std::vector<Tensor3> LargeStrain::face_stress(const Displaced& state, Index first, Index count) {
  std::vector<Tensor3> stress(count, Tensor3::Zero());
  visit(state.unknowns(), state.known, [&](Index f, const Tensor3& deformation, const Tensor3& p) {
    if (f < first || f >= first + count) return;
    stress[f - first] = p * deformation.transpose() / deformation.determinant();
  });
  return stress;
}

/// Stress of a cell by the pyramids over its faces: sum V_fP P F^T / sum V_fP J, the mean over the deformed cell. The
/// ghosts' faces are another rank's.
std::vector<Tensor3> LargeStrain::cell_stress(const Displaced& state) {
  constexpr int size = 10;
  std::vector<double> sums(std::size_t(mesh_.cells.n_local()) * size, 0);
  visit(state.unknowns(), state.known, [&](Index f, const Tensor3& deformation, const Tensor3& p) {
    const auto [here, there] = elastic::pyramids(mesh_, geometry_, f);
    const Tensor3 tau = p * deformation.transpose();
    const double j = deformation.determinant();
    const auto add = [&](Index c, double volume) {
      double* at = sums.data() + std::size_t(c) * size;
      for (int i = 0; i < 9; ++i) at[i] += volume * tau(i / 3, i % 3);
      at[9] += volume * j;
    };
    add(mesh_.owner[f], here);
    if (f < mesh_.n_interior) add(mesh_.neighbour[f], there);
  });
  mesh_.cells.add_to_owners(sums, size);
  std::vector<Tensor3> stress(mesh_.cells.n_owned());
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    for (int i = 0; i < 9; ++i)
      stress[c](i / 3, i % 3) =
          sums[std::size_t(c) * size + std::size_t(i)] / sums[std::size_t(c) * size + 9];
  return stress;
}

}  // namespace couplet::solid
