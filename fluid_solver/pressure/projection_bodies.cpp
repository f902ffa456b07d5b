// SPDX-License-Identifier: Apache-2.0
// What immersed bodies change in the pressure equation.
#include "fluid_solver/pressure/projection.hpp"

namespace couplet::fluid {

template <int D>
void PressureProjection<D>::mark_bodies(double time) {
  if (!k_.bodies->mark(time, *k_.step.to) && k_.around_bodies) return;
  auto around = std::make_shared<Placement<D>>(*k_.step.to);
  for (Index f = 0; f < k_.mesh.n_flux_faces(); ++f) {
    if (!k_.bodies->blocked(f)) continue;
    around->conductance[f] = 0;
    if (!around->oblique.empty()) around->oblique[f].setZero();
  }
  k_.around_bodies = std::move(around);
  k_.assembled = nullptr;
  pressure_.refresh();
}

template <int D>
void PressureProjection<D>::clear_bodies(std::vector<double>& values) const {
  for (Index c = 0; c < k_.mesh.cells.n_local(); ++c)
    if (k_.bodies->is_solid(c)) values[c] = 0;
}

/// In the cells of a body: mean of the fluid cells beside them, so that the gradient there sees no jump.
template <int D>
void PressureProjection<D>::fill_pressure_in_bodies() {
  std::vector<double> weight(k_.p.size(), 0.0), mean(k_.p.size(), 0.0);
  const auto add = [&](Index solid, Index fluid, double g) {
    if (!k_.bodies->is_solid(solid) || k_.bodies->is_solid(fluid)) return;
    weight[solid] += g;
    mean[solid] += g * k_.p[fluid];
  };
  for (Index f = 0; f < k_.mesh.n_interior; ++f) {
    add(k_.mesh.owner[f], k_.mesh.neighbour[f], k_.step.to->conductance[f]);
    add(k_.mesh.neighbour[f], k_.mesh.owner[f], k_.step.to->conductance[f]);
  }
  for (Index c = 0; c < k_.mesh.cells.n_owned(); ++c)
    if (weight[c] > 0) k_.p[c] = mean[c] / weight[c];
  k_.mesh.cells.update_ghosts(k_.p);
}

template void PressureProjection<2>::mark_bodies(double);
template void PressureProjection<2>::clear_bodies(std::vector<double>&) const;
template void PressureProjection<2>::fill_pressure_in_bodies();
template void PressureProjection<3>::mark_bodies(double);
template void PressureProjection<3>::clear_bodies(std::vector<double>&) const;
template void PressureProjection<3>::fill_pressure_in_bodies();

}  // namespace couplet::fluid
