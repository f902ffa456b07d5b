// SPDX-License-Identifier: Apache-2.0
// FractionalStep: what immersed bodies change in the pressure equation.
#include "fluid_solver/fractional_step.hpp"

namespace couplet::fluid {

template <int D>
void FractionalStep<D>::mark_bodies(double time) {
  if (!bodies_->mark(time, *step_.to) && around_bodies_) return;
  auto around = std::make_shared<Placement<D>>(*step_.to);
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    if (!bodies_->blocked(f)) continue;
    around->conductance[f] = 0;
    if (!around->oblique.empty()) around->oblique[f].setZero();
  }
  around_bodies_ = std::move(around);
  assembled_ = nullptr;
  pressure_.refresh();
}

template <int D>
void FractionalStep<D>::clear_bodies(std::vector<double>& values) const {
  if (!bodies_) return;
  for (Index c = 0; c < mesh_.cells.n_local(); ++c)
    if (bodies_->is_solid(c)) values[c] = 0;
}

/// In the cells of a body: mean of the fluid cells beside them, so that the gradient there sees no jump.
template <int D>
void FractionalStep<D>::fill_pressure_in_bodies() {
  std::vector<double> weight(p_.size(), 0.0), mean(p_.size(), 0.0);
  const auto add = [&](Index solid, Index fluid, double g) {
    if (!bodies_->is_solid(solid) || bodies_->is_solid(fluid)) return;
    weight[solid] += g;
    mean[solid] += g * p_[fluid];
  };
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    add(mesh_.owner[f], mesh_.neighbour[f], step_.to->conductance[f]);
    add(mesh_.neighbour[f], mesh_.owner[f], step_.to->conductance[f]);
  }
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    if (weight[c] > 0) p_[c] = mean[c] / weight[c];
  mesh_.cells.update_ghosts(p_);
}

template void FractionalStep<2>::mark_bodies(double);
template void FractionalStep<2>::clear_bodies(std::vector<double>&) const;
template void FractionalStep<2>::fill_pressure_in_bodies();
template void FractionalStep<3>::mark_bodies(double);
template void FractionalStep<3>::clear_bodies(std::vector<double>&) const;
template void FractionalStep<3>::fill_pressure_in_bodies();

}  // namespace couplet::fluid
