// SPDX-License-Identifier: Apache-2.0
// What blocked gaps change in the pressure equation.
#include "fluid_solver/pressure/projection.hpp"

namespace couplet::fluid {
namespace {

// Of its conductance a blocked face keeps this share: what leaks is as small, and the pressure in the gap is that
// of a fluid at rest in a slot between the pressures at its two ends (lubrication: linear along a parallel slot).
constexpr double kept = 1e-6;

}  // namespace

template <int D>
void PressureProjection<D>::mark_gaps() {
  const Placement<D>& now = *k_.step.to;
  const bool changed = k_.gaps->mark(k_.step.points.empty() ? k_.points_at_rest : k_.step.points, now);
  if (changed) {
    k_.assembled = nullptr;
    pressure_.refresh();
    if (k_.gaps->active()) k_.pockets->find(k_.gaps->blocked_by());
  }
  k_.around_gaps.reset();
  if (!k_.gaps->active()) return;
  auto around = std::make_shared<Placement<D>>(now);
  for (Index f = 0; f < k_.mesh.n_interior; ++f) {
    if (!k_.gaps->blocked(f)) continue;
    around->conductance[f] *= kept;
    if (!around->oblique.empty()) around->oblique[f].setZero();
  }
  k_.around_gaps = std::move(around);
}

/// phi^p of blocked faces: what the mesh sweeps, nothing passes.
template <int D>
void PressureProjection<D>::block_gaps(std::vector<double>& phi) const {
  for (Index f = 0; f < k_.mesh.n_interior; ++f)
    if (k_.gaps->blocked(f)) phi[f] = k_.step.swept.empty() ? 0 : k_.step.swept[f] / k_.step.dt;
}

/// No source in blocked cells: the pressure there is between those at the border. What they lose in volume as the
/// mesh presses them they keep to themselves, so that the squeeze flow of the last film is left out.
template <int D>
void PressureProjection<D>::clear_gaps(std::vector<double>& b) const {
  for (Index c = 0; c < k_.mesh.cells.n_local(); ++c)
    if (k_.gaps->is_blocked(c)) b[c] = 0;
}

/// A free cell sees its own pressure at a blocked face, as at a wall: linear in between it would feel the slope of
/// the pressure along the gap, which drives nothing.
template <int D>
void PressureProjection<D>::part_from_gaps(const Placement<D>& at, const std::vector<double>& p,
                                           Vectors<D>& sum) const {
  for (Index f = 0; f < k_.mesh.n_interior; ++f) {
    if (!k_.gaps->blocked(f)) continue;
    const Index o = k_.mesh.owner[f], n = k_.mesh.neighbour[f];
    const double linear = at.weight[f] * p[o] + (1 - at.weight[f]) * p[n];
    if (!k_.gaps->is_blocked(o)) sum[o] += (p[o] - linear) * at.area[f];
    if (!k_.gaps->is_blocked(n)) sum[n] -= (p[n] - linear) * at.area[f];
  }
}

template void PressureProjection<2>::mark_gaps();
template void PressureProjection<2>::block_gaps(std::vector<double>&) const;
template void PressureProjection<2>::clear_gaps(std::vector<double>&) const;
template void PressureProjection<2>::part_from_gaps(const Placement<2>&, const std::vector<double>&,
                                                    Vectors<2>&) const;
template void PressureProjection<3>::part_from_gaps(const Placement<3>&, const std::vector<double>&,
                                                    Vectors<3>&) const;
template void PressureProjection<3>::mark_gaps();
template void PressureProjection<3>::block_gaps(std::vector<double>&) const;
template void PressureProjection<3>::clear_gaps(std::vector<double>&) const;

}  // namespace couplet::fluid
