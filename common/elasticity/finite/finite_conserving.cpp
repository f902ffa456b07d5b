// SPDX-License-Identifier: Apache-2.0
// The step that conserves energy; what holds a body at its patches.
#include <algorithm>
#include <cstring>

#include "common/elasticity/finite/finite_kernel_of.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {

/// F, W and the cells' J of the state where a step begins.
template <int D>
void FiniteKernelOf<D>::set_start(std::span<const double> unknowns, std::span<const double> known) {
  has_start_ = false;
  space_.fill(unknowns, known);
  space_.clear_forces();
  internal_forces();
  for (finite::Group<D>& group : groups_) {
    group.start.resize(group.states.size());
    for (std::size_t i = 0; i < group.states.size(); ++i) {
      finite::Start& start = group.start[i];
      std::memcpy(start.f, group.states[i].f, sizeof start.f);
      const Invariants at = finite::invariants(start.f);
      Energy energy;
      group.law->evaluate({&at, 1}, of_cells_.empty(), {&energy, 1});
      start.energy = energy.w;
    }
  }
  if (edges_) edges_->set_start(of_cells_.empty());
  has_start_ = true;
}

/// Of a step that conserves energy; the tangent stays that of the states in its middle, which is symmetric and differs
/// by the square of the step.
template <int D>
void FiniteKernelOf<D>::conserving_forces() {
  // The states' pressure belongs to their tangent.
  if (!of_cells_.empty())
    for (finite::Group<D>& group : groups_) finite::add_pressures<D>(group, of_cells_.data());
  for (const finite::Group<D>& group : groups_) {
    const double least = finite::least_end_ratio<D>(group);
    if (!(least >= worst_.ratio)) worst_.ratio = least;
  }
  const bool is_sound = parallel::min(mesh_.comm, worst_.ratio) > 0;
  if (!is_sound) {
    worst_.ratio = std::min(worst_.ratio, 0.0);
    return;
  }
  if (!of_cells_.empty()) conserving_pressures();
  if (edges_) edges_->to_conserving(of_cells_.empty());
  for (const finite::Group<D>& group : groups_) {
    finite::conserving_loop<D>(group, values());
    if (edges_) finite::from_edges<D>(group, values(), *edges_);
  }
}

template <int D>
std::vector<Wrench> FiniteKernelOf<D>::holding_forces(std::span<const double> unknowns,
                                                      std::span<const double> known,
                                                      const ElasticLoads& loads) {
  has_start_ = false;
  set_own_pressures(false);
  space_.clear_forces();
  if (!loads.faces.empty()) space_.spread_face_forces(loads.faces);
  if (!loads.cells.empty()) space_.spread_cell_forces(loads.cells);
  space_.negate_forces();
  space_.fill(unknowns, known);
  internal_forces();
  pressure_force_ = pressure_.add_forces(space_, 1);
  space_.add_springs(known);
  return space_.held(known, true);
}

template void FiniteKernelOf<2>::set_start(std::span<const double>, std::span<const double>);
template void FiniteKernelOf<2>::conserving_forces();
template std::vector<Wrench> FiniteKernelOf<2>::holding_forces(std::span<const double>,
                                                               std::span<const double>, const ElasticLoads&);
template void FiniteKernelOf<3>::set_start(std::span<const double>, std::span<const double>);
template void FiniteKernelOf<3>::conserving_forces();
template std::vector<Wrench> FiniteKernelOf<3>::holding_forces(std::span<const double>,
                                                               std::span<const double>, const ElasticLoads&);

}  // namespace couplet::elastic
