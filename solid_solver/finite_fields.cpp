// SPDX-License-Identifier: Apache-2.0
// What follows from the accepted state at large strain: Cauchy's stress, work of a stage, the audit.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/elasticity/symmetric_faces.hpp"
#include "common/log/doubt.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/solid.hpp"
#include "solid_solver/system.hpp"

namespace couplet {

/// The kernel at the accepted displacement. Collective.
void Solid::linearise_accepted() const {
  std::vector<double> rows(elastic_.n_unknowns());
  finite_->kernel().forget_start();
  finite_->kernel().linearise(unknowns_of(state_.cell_u, state_.face_u), known_accepted_, 0, rows);
}

/// Cauchy's stress sigma = P F^T / J of local faces [Pa].
std::vector<Tensor3> Solid::finite_face_stress(Index first, Index count) const {
  linearise_accepted();
  std::vector<Tensor3> stress(count, Tensor3::Zero());
  finite_->kernel().visit([&](Index f, const Tensor3& deformation, const Tensor3& p) {
    if (f < first || f >= first + count) return;
    stress[f - first] = p * deformation.transpose() / deformation.determinant();
  });
  return stress;
}

/// Of a cell by the pyramids over its faces: sum V_fP P F^T / sum V_fP J, the mean over the deformed cell. The
/// ghosts' faces are another rank's.
std::vector<Tensor3> Solid::finite_cell_stress() const {
  linearise_accepted();
  constexpr int size = 10;
  std::vector<double> sums(std::size_t(mesh_.cells.n_local()) * size, 0);
  finite_->kernel().visit([&](Index f, const Tensor3& deformation, const Tensor3& p) {
    const auto [here, there] = pyramids(mesh_, f);
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

/// The inner work of a stage: the scheme's inner force at its place on the change over it.
void Solid::add_finite_work(const StageWork& work, const SolidState& before) {
  SolidEnergies& energies = trial_.energies;
  std::vector<double> change = unknowns_of(trial_.cell_u, trial_.face_u);
  const std::vector<double> start = unknowns_of(before.cell_u, before.face_u);
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= start[i];
  if (parameters_.time_scheme.type != TimeScheme::trapezoidal) mean_of_ends(work);
  std::vector<double> force(unknowns_.size());
  finite_->kernel().linearise(unknowns_, work.known, 0, force);
  double inside = 0, outside = 0;
  for (std::size_t i = 0; i < change.size(); ++i) {
    inside += force[i] * change[i];
    outside += load_rows_[i] * change[i];
  }
  const SolidDamping damping = parameters_.damping.value_or(SolidDamping{});
  if (damping.mass > 0) {
    const ElasticField moved{change, work.known_change};
    energies.damping_loss += damping.mass / work.stage.dt * kernel_.product(ElasticPart::mass, moved, moved);
  }
  energies.internal_work += inside;
  energies.external_work += outside;
  energies.kinetic = kinetic_energy(trial_, known_rate_);
}

/// The strain energy at large strain is that of the law itself: nothing is compared in a static run. A dynamic one
/// must not hold more than loads and initial motion have brought in.
void Solid::audit_finite() {
  if (!is_dynamic() || !prescribed_.is_zero()) return;
  const double strain = finite_->energy(unknowns_of(state_.cell_u, state_.face_u), known_accepted_);
  judge_energy(strain,
               "a time scheme that does not keep the energy of a law that is not linear; a shorter step, "
               "'energy-momentum: true' or 'time-scheme: {type: bathe}' stops it");
}

}  // namespace couplet
