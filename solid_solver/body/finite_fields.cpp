// SPDX-License-Identifier: Apache-2.0
// Cauchy's stress from the accepted state at large strain.
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "solid_solver/body/solid_fields.hpp"

namespace couplet {

/// F and P of the accepted state. Collective.
void SolidFields::visit_accepted(const LargeStrain::Take& take) const {
  body_.finite()->visit(body_.unknowns_of(state_.cell_u, state_.face_u), state_.known, take);
}

/// Cauchy's stress sigma = P F^T / J of local faces [Pa].
std::vector<Tensor3> SolidFields::finite_face_stress(Index first, Index count) const {
  std::vector<Tensor3> stress(count, Tensor3::Zero());
  visit_accepted([&](Index f, const Tensor3& deformation, const Tensor3& p) {
    if (f < first || f >= first + count) return;
    stress[f - first] = p * deformation.transpose() / deformation.determinant();
  });
  return stress;
}

/// Of a cell by the pyramids over its faces: sum V_fP P F^T / sum V_fP J, the mean over the deformed cell. The
/// ghosts' faces are another rank's.
std::vector<Tensor3> SolidFields::finite_cell_stress() const {
  constexpr int size = 10;
  std::vector<double> sums(std::size_t(mesh_.cells.n_local()) * size, 0);
  visit_accepted([&](Index f, const Tensor3& deformation, const Tensor3& p) {
    const auto [here, there] = pyramids(mesh_, geometry_, f);
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

}  // namespace couplet
