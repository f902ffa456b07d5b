// SPDX-License-Identifier: Apache-2.0
// What immersed bodies change in the pressure equation.
#include "fluid_solver/pressure/projection.hpp"

namespace couplet::fluid {

template <int D>
void PressureProjection<D>::mark_bodies(double time) {
  using Changed = typename ImmersedBodies<D>::Changed;
  const Placement<D>& now = *k_.step.to;
  const Changed changed =
      k_.bodies->mark(time, now, k_.step.points.empty() ? k_.points_at_rest : k_.step.points);
  if (changed == Changed::nothing && k_.bodies_at == k_.step.to) return;
  auto around = std::make_shared<Placement<D>>(now);
  for (Index f = 0; f < k_.mesh.n_flux_faces(); ++f) {
    const double open = k_.bodies->open(f);
    if (open == 1) continue;
    around->conductance[f] *= open;
    if (!around->oblique.empty()) around->oblique[f] *= open;
  }
  k_.around_bodies = std::move(around);
  k_.bodies_at = k_.step.to;
  if (changed != Changed::nothing) k_.assembled = nullptr;
  if (changed == Changed::cells) pressure_.refresh();
}

template <int D>
void PressureProjection<D>::clear_bodies(std::vector<double>& values) const {
  for (Index c = 0; c < k_.mesh.cells.n_local(); ++c)
    if (k_.bodies->is_closed(c)) values[c] = 0;
}

/// The gradient in closed cells: deeper ones have no pressure.
template <int D>
void PressureProjection<D>::clear_bodies(Vectors<D>& values) const {
  for (Index c = 0; c < k_.mesh.cells.n_local(); ++c)
    if (k_.bodies->is_closed(c)) values[c].setZero();
}

/// In closed cells: mean of the fluid cells beside them, so that the gradient there sees no jump.
template <int D>
void PressureProjection<D>::fill_pressure_in_bodies() {
  std::vector<double> weight(k_.p.size(), 0.0), mean(k_.p.size(), 0.0);
  const auto add = [&](Index closed, Index fluid, double g) {
    if (!k_.bodies->is_closed(closed) || k_.bodies->is_closed(fluid)) return;
    weight[closed] += g;
    mean[closed] += g * k_.p[fluid];
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
template void PressureProjection<2>::clear_bodies(Vectors<2>&) const;
template void PressureProjection<2>::fill_pressure_in_bodies();
template void PressureProjection<3>::mark_bodies(double);
template void PressureProjection<3>::clear_bodies(std::vector<double>&) const;
template void PressureProjection<3>::clear_bodies(Vectors<3>&) const;
template void PressureProjection<3>::fill_pressure_in_bodies();

}  // namespace couplet::fluid
