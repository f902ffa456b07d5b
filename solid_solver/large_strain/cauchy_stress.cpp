// SPDX-License-Identifier: Apache-2.0
// Strain and Cauchy's stress at large strain.
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "solid_solver/large_strain/large_strain.hpp"

namespace couplet::solid {

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

/// Of a cell by the pyramids over its faces: sum V_fP P F^T / sum V_fP J, the mean over the deformed cell. The
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
