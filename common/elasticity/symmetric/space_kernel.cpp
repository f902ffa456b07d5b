// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/space_kernel.hpp"

namespace couplet::elastic {

template <int D>
void SpaceKernel<D>::spread_pressure(std::span<const double> pressure) {
  const mesh::Mesh& mesh = space_.mesh();
  const std::vector<double> shared = shared_pressure(pressure);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] >= mesh.cells.n_owned()) continue;  // another rank's
    const FaceRows face = face_rows(mesh, space_.rows(), f);
    const double scale = shared[f] * face.volume;
    for (const FaceRows::Row& row : face.all()) {
      double* to = space_.force_at(row.place);
      for (int a = 0; a < D; ++a) to[a] += scale * row.b[a];
      if (face.is_ring) to[0] += scale * row.b[2];
    }
  }
}

template <int D>
Vec3 SpaceKernel<D>::add_face_forces(std::span<const double> forces, std::span<double> rhs) {
  space_.clear_forces();
  space_.spread_face_forces(forces);
  space_.add_collected(rhs);
  return space_.acting(forces);
}

template <int D>
void SpaceKernel<D>::add_cell_forces(std::span<const double> forces, std::span<double> rhs) {
  space_.clear_forces();
  space_.spread_cell_forces(forces);
  space_.add_collected(rhs);
}

template <int D>
void SpaceKernel<D>::add_pressure(std::span<const double> pressure, std::span<double> rhs) {
  space_.clear_forces();
  spread_pressure(pressure);
  space_.add_collected(rhs);
}

template <int D>
void SpaceKernel<D>::apply_with_mass(std::span<const double> unknowns, std::span<const double> known,
                                     double mass_factor, bool with_stiffness, std::span<double> result) {
  space_.fill(unknowns, known);
  space_.clear_forces();
  if (with_stiffness) {
    internal_forces();
    space_.add_springs(known);
  }
  if (mass_factor > 0) space_.add_mass_forces(mass_factor);
  space_.collect();
  space_.take_rows(with_stiffness ? unknowns : std::span<const double>(), known, result);
}

/// The forces of u on all nodes and points, times what v moves them.
template <int D>
double SpaceKernel<D>::product(ElasticPart part, const ElasticField& u, const ElasticField& v) {
  space_.fill(u.unknowns, u.known);
  space_.clear_forces();
  if (part == ElasticPart::stiffness) internal_forces();
  if (part == ElasticPart::springs) space_.add_springs(u.known);
  if (part == ElasticPart::mass) space_.add_mass_forces(1);
  space_.fill(v.unknowns, v.known);
  return space_.work();
}

template <int D>
std::vector<Wrench> SpaceKernel<D>::holding_forces(std::span<const double> unknowns,
                                                   std::span<const double> known, const ElasticLoads& loads) {
  space_.clear_forces();
  if (!loads.faces.empty()) space_.spread_face_forces(loads.faces);
  if (!loads.cells.empty()) space_.spread_cell_forces(loads.cells);
  if (!loads.pressure.empty()) spread_pressure(loads.pressure);
  space_.negate_forces();
  space_.fill(unknowns, known);
  internal_forces();
  space_.add_springs(
      known);  // at a vertex that a support shares the support takes their part along what it knows
  return space_.held(known, false);
}

template class SpaceKernel<2>;
template class SpaceKernel<3>;

}  // namespace couplet::elastic
