// SPDX-License-Identifier: Apache-2.0
// What acts on the symmetric operator: loads, mass and what supports hold, by the trial functions of its
// strain (SymmetricSpace).
#include "common/elasticity/symmetric/symmetric_kernel.hpp"

namespace couplet::elastic {

template <int D>
void SymmetricKernel<D>::spread_pressure(std::span<const double> pressure) {
  std::vector<double> shared(shared_mine_.size());
  if (rows_.volume_by_cells()) {
    // It takes no part in the sharing of edges, nor does the pressure that acts on it.
    for (std::size_t i = 0; i < shared.size(); ++i) shared[i] = pressure[shared_mine_[i]];
  } else if (edges_) {
    edges_->clear();
    for (std::size_t i = 0; i < shared_mine_.size(); ++i)
      for (const Index e : edges_->edges_of(i))
        for (int a = 0; a < 3; ++a)
          edges_->at(e)[a] += shared_[i / 4].part[i % 4] * pressure[shared_mine_[i]];
    edges_->finish_means();
    for (std::size_t i = 0; i < shared_mine_.size(); ++i) {
      for (const Index e : edges_->edges_of(i)) shared[i] += edges_->at(e)[0] / 3;
      shared[i] = (1 - SharedEdges::share) * pressure[shared_mine_[i]] + SharedEdges::share * shared[i];
    }
  }
  const auto force = [&](Index node) { return space_.forces() + std::size_t(node) * stride; };
  const auto point_force = [&](Index v) { return space_.point_forces() + std::size_t(v) * stride; };
  const auto push = [&](Index f, double p) {
    const SymmetricFace<D> face = symmetric_face<D>(mesh_, rows_, f);
    const double scale = p * face.volume * face.inverse;
    double* there = force(space_.node_across(f));
    double* here = force(mesh_.owner[f]);
    for (int a = 0; a < D; ++a) {
      there[a] += scale * face.area[a];
      here[a] -= scale * face.area[a];
      for (int i = 0; i < D - 1; ++i) {
        point_force(face.plus[i])[a] += scale * face.across[i][a];
        point_force(face.minus[i])[a] -= scale * face.across[i][a];
      }
    }
  };
  for (const Index f : mine_) push(f, pressure[f]);
  for (std::size_t i = 0; i < shared_mine_.size(); ++i) push(shared_mine_[i], shared[i]);
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
template void SymmetricKernel<2>::spread_pressure(std::span<const double>);
template void SymmetricKernel<3>::spread_pressure(std::span<const double>);

}  // namespace couplet::elastic
