// SPDX-License-Identifier: Apache-2.0
// Forces on the solid, and the largest strain, rotation and stress of the accepted state.
#include <algorithm>
#include <cmath>

#include "common/parallel/collective.hpp"
#include "solid_solver/body/solid_fields.hpp"

namespace couplet::solid {
namespace {

/// Sum over the ranks. Collective.
elastic::Wrench sum_of(const elastic::Wrench& here, MPI_Comm comm) {
  elastic::Wrench total;
  double numbers[6];
  for (int a = 0; a < 3; ++a) numbers[a] = here.force[a], numbers[3 + a] = here.moment[a];
  MPI_Allreduce(MPI_IN_PLACE, numbers, 6, MPI_DOUBLE, MPI_SUM, comm);
  for (int a = 0; a < 3; ++a) total.force[a] = numbers[a], total.moment[a] = numbers[3 + a];
  return total;
}

}  // namespace

std::vector<PatchForce> SolidFields::reactions(std::span<const double> points) const {
  std::vector<PatchForce> forces = reactions_by_trial_functions();
  if (!forces.empty()) return forces;
  // Loops only from the first to the last held face, often a small part of the boundary.
  Index first = mesh_.n_flux_faces(), end = mesh_.n_interior;
  for (std::size_t p = 0; p < mesh_.patches.size(); ++p) {
    const mesh::Patch& patch = mesh_.patches[p];
    if (!body_.boundaries().holds(p) || patch.count == 0) continue;
    first = std::min(first, patch.first);
    end = std::max(end, patch.first + patch.count);
  }
  const std::vector<Tensor3> stress = face_stress(first, std::max<Index>(end - first, 0), points);
  for (std::size_t p = 0; p < mesh_.patches.size(); ++p) {
    if (!body_.boundaries().holds(p)) continue;
    const mesh::Patch& patch = mesh_.patches[p];
    elastic::Wrench held;
    for (Index f = patch.first; f < patch.first + patch.count; ++f)
      held.add(elastic_.holding_force(f, stress[f - first], state_.face_u, state_.known),
               geometry_.face_centre[f]);
    forces.push_back({sum_of(held, mesh_.comm), patch.name});
  }
  return forces;
}

/// Reactions as residual of the stress; empty for a gradient without trial functions.
std::vector<PatchForce> SolidFields::reactions_by_trial_functions() const {
  std::vector<PatchForce> forces;
  const std::vector<double> u = body_.unknowns_of(state_.cell_u, state_.face_u);
  body_.place_pressures(state_.time);
  const std::vector<elastic::Wrench> held = body_.equilibrium().holding_forces(u, state_.known, loads_now());
  if (held.empty()) return forces;
  for (std::size_t p = 0; p < mesh_.patches.size(); ++p) {
    if (!body_.boundaries().holds(p)) continue;
    forces.push_back({sum_of(held[p], mesh_.comm), mesh_.patches[p].name});
  }
  return forces;
}

elastic::ElasticLoads SolidFields::loads_now() const {
  elastic::ElasticLoads loads;
  loads.faces = body_.dead_loads(state_.time);
  for (std::size_t i = 0; i < last_.interface.size(); ++i) loads.faces[i] += last_.interface[i];
  if (body_.seat() && !last_.contact.empty()) body_.seat()->add_to_faces(last_.contact, loads.faces);
  loads.cells = body_.body_forces(state_.time);
  if (ThermalStrain* thermal = body_.thermal()) loads.pressure = thermal->pressure(state_.time);
  return loads;
}

Vec3 SolidFields::total_load() const {
  Vec3 load = last_.body_force + last_.face_force + body_.equilibrium().pressure_force();
  for (int a = 0; a < 3; ++a) load[a] = parallel::sum(mesh_.comm, load[a]);
  return load;
}

Deformation SolidFields::deformation(std::span<const double> points) const {
  double gradient = 0, strain = 0, rotation = 0;
  body_.visit_gradients(displacement(points), [&](Index, const Tensor3& g) {
    gradient = std::max(gradient, g.squaredNorm());
    strain = std::max(strain, (0.5 * (g + g.transpose())).squaredNorm());
    rotation = std::max(rotation, (0.5 * (g - g.transpose())).squaredNorm());
  });
  // The skew part of a small rotation phi contains phi twice.
  return {.gradient = parallel::max(mesh_.comm, std::sqrt(gradient)),
          .strain = parallel::max(mesh_.comm, std::sqrt(strain)),
          .rotation = parallel::max(mesh_.comm, std::sqrt(rotation / 2))};
}

}  // namespace couplet::solid
