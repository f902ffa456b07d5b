// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/body/small_strain.hpp"

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/method/contact_newton.hpp"

namespace couplet::solid {

void SmallStrain::prepare(const SolidProblem& problem, SolidSystem& system) const {
  system.method = make_solution_method(problem, parameters_.method);
}

std::vector<double> SmallStrain::force_of_known(std::span<const double> known) const {
  std::vector<double> still(rows_.n_unknowns(), 0), force(still.size());
  kernel_.apply(still, known, force);
  return force;
}

linalg::SolveStatistics SmallStrain::find(const EquilibriumLoad& load, SolidSystem& system,
                                          std::span<double> u) {
  if (!load.pressing) return system.method->solve(load.rows, u);
  const linalg::LinearMap stiffness = [&](std::span<const double> x, std::span<double> y) {
    if (load.mass_factor > 0) return kernel_.apply_with_mass(x, {}, load.mass_factor, true, y);
    kernel_.apply(x, {}, y);
  };
  return solve_with_contact({mesh_.comm, stiffness, *system.method, *load.pressing, load.known,
                             parameters_.method.relative_tolerance, parameters_.method.max_iterations},
                            load.rows, u);
}

void SmallStrain::explain_failure(const SolveFailure& failure) const {
  throw SchemeFailure("The static step failed, and a shorter step would solve the same equations: {}",
                      failure.what());
}

std::vector<double> SmallStrain::forces(std::span<const double> unknowns, std::span<const double> known) {
  std::vector<double> force(unknowns.size());
  kernel_.apply(unknowns, known, force);
  return force;
}

double SmallStrain::energy(std::span<const double> unknowns, std::span<const double> known) {
  const elastic::ElasticField u{unknowns, known};
  return parallel::sum(mesh_.comm, 0.5 * kernel_.product(elastic::ElasticPart::stiffness, u, u));
}

std::vector<elastic::Wrench> SmallStrain::holding_forces(std::span<const double> unknowns,
                                                         std::span<const double> known,
                                                         const elastic::ElasticLoads& loads) {
  return kernel_.holding_forces(unknowns, known, loads);
}

void SmallStrain::to_strain(std::span<Tensor3> gradients) const {
  for (Tensor3& e : gradients) e = (0.5 * (e + e.transpose())).eval();
}

std::vector<Tensor3> SmallStrain::face_stress(const Displaced& state, Index first, Index count) {
  std::vector<Tensor3> stress = state.face_gradients(first, count);
  for (Index i = 0; i < count; ++i) stress[i] = rows_.stress(mesh_.owner[first + i], stress[i]);
  for (const auto& effect : effects_) effect->add_face_stress(first, stress);
  return stress;
}

std::vector<Tensor3> SmallStrain::cell_stress(const Displaced& state) {
  std::vector<Tensor3> stress = state.cell_gradients();
  for (std::size_t c = 0; c < stress.size(); ++c) stress[c] = rows_.stress(Index(c), stress[c]);
  for (const auto& effect : effects_) effect->add_cell_stress(stress);
  // Across a 2-D scene: lambda tr(epsilon) in plane strain (it stands there already), nothing in plane
  // stress.
  if (mesh_.dim == 2 && parameters_.plane == SolidParameters::Plane::stress)
    for (Tensor3& s : stress) s(2, 2) = 0;
  return stress;
}

}  // namespace couplet::solid
