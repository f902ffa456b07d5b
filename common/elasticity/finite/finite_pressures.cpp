// SPDX-License-Identifier: Apache-2.0
// One volume ratio a cell: its pressure, those that Newton's method carries along, those that conserve energy.
#include <algorithm>
#include <cmath>

#include "common/base/processor_clones.hpp"
#include "common/elasticity/finite/finite_kernel_of.hpp"

namespace couplet::elastic {
namespace {

COUPLET_PROCESSOR_CLONES void volume_pass(const finite::Group<3>& group, const finite::Values<3>& at) {
  finite::volume_loop<3>(group, at);
}
COUPLET_PROCESSOR_CLONES void volume_pass(const finite::Group<2>& group, const finite::Values<2>& at) {
  finite::volume_loop<2>(group, at);
}
}  // namespace

/// From V J of the cells to U'(J).
template <int D>
void FiniteKernelOf<D>::find_pressures() {
  const std::span<double> cells = std::span(of_cells_).first(std::size_t(mesh_.cells.n_local()));
  mesh_.cells.add_to_owners(cells);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const double swelling = swelling_.empty() ? 1 : swelling_[c];
    const BulkOf<double> bulk = law_of(c).bulk(cells[c] / (volume_[c] * swelling));
    cells[c] = bulk_pressure_[c] = bulk.pressure;
    if (!own_pressure_.empty()) cells[c] = own_pressure_[c] + fraction_ * pressure_change_[c];
    modulus_[c] = bulk.modulus / (volume_[c] * swelling);
    energy_ += volume_[c] * swelling * bulk.u;
  }
  mesh_.cells.update_ghosts(cells);
  if (edges_) pressures_ = of_cells_;
}

/// U'' dJ of owned cells for the change in the space.
template <int D>
void FiniteKernelOf<D>::sum_volume_changes() {
  std::ranges::fill(of_cells_, 0.0);
  for (const finite::Group<D>& group : groups_) volume_pass(group, values());
  const std::span<double> cells = std::span(of_cells_).first(std::size_t(mesh_.cells.n_local()));
  mesh_.cells.add_to_owners(cells);
  for (std::size_t c = 0; c < modulus_.size(); ++c) cells[c] *= modulus_[c];
}

template <int D>
void FiniteKernelOf<D>::set_own_pressures(bool on) {
  own_pressure_ = on ? bulk_pressure_ : std::vector<double>();
  pressure_change_.assign(own_pressure_.size(), 0);
  fraction_ = 0;
}

template <int D>
void FiniteKernelOf<D>::predict_pressures(std::span<const double> change,
                                          std::span<const double> known_change) {
  space_.fill(change, known_change);
  sum_volume_changes();
  for (std::size_t c = 0; c < own_pressure_.size(); ++c)
    pressure_change_[c] = of_cells_[c] + bulk_pressure_[c] - own_pressure_[c];
}

template <int D>
void FiniteKernelOf<D>::accept_pressures() {
  for (std::size_t c = 0; c < own_pressure_.size(); ++c) own_pressure_[c] += fraction_ * pressure_change_[c];
  std::ranges::fill(pressure_change_, 0.0);
  fraction_ = 0;
}

template <int D>
void FiniteKernelOf<D>::add_pressure_defect(std::span<double> result) {
  const std::span<double> cells = std::span(of_cells_).first(std::size_t(mesh_.cells.n_local()));
  for (std::size_t c = 0; c < own_pressure_.size(); ++c)
    cells[c] = bulk_pressure_[c] - own_pressure_[c] - fraction_ * pressure_change_[c];
  mesh_.cells.update_ghosts(cells);
  space_.clear_forces();
  for (const finite::Group<D>& group : groups_) finite::pressure_loop<D>(group, values());
  space_.add_collected(result);
}

/// p* = [U(J_1) - U(J_0)] / (J_1 - J_0) of the cells, J_1 being that of 2 F - F_0.
template <int D>
void FiniteKernelOf<D>::conserving_pressures() {
  std::ranges::fill(of_cells_, 0.0);
  std::vector<double> before(of_cells_.size(), 0);
  for (const finite::Group<D>& group : groups_) {
    finite::end_volumes<D>(group, false, before);
    finite::end_volumes<D>(group, true, of_cells_);
  }
  const std::span<double> cells = std::span(of_cells_).first(std::size_t(mesh_.cells.n_local()));
  const std::span<double> starts = std::span(before).first(cells.size());
  mesh_.cells.add_to_owners(cells);
  mesh_.cells.add_to_owners(starts);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const double j1 = cells[c] / volume_[c], j0 = starts[c] / volume_[c];
    const FiniteLaw& law = law_of(c);
    cells[c] = std::abs(j1 - j0) > finite::smallest_change ? (law.bulk(j1).u - law.bulk(j0).u) / (j1 - j0)
                                                           : law.bulk(0.5 * (j0 + j1)).pressure;
  }
  mesh_.cells.update_ghosts(cells);
}

template void FiniteKernelOf<2>::find_pressures();
template void FiniteKernelOf<2>::sum_volume_changes();
template void FiniteKernelOf<2>::set_own_pressures(bool);
template void FiniteKernelOf<2>::predict_pressures(std::span<const double>, std::span<const double>);
template void FiniteKernelOf<2>::accept_pressures();
template void FiniteKernelOf<2>::add_pressure_defect(std::span<double>);
template void FiniteKernelOf<2>::conserving_pressures();

template void FiniteKernelOf<3>::find_pressures();
template void FiniteKernelOf<3>::sum_volume_changes();
template void FiniteKernelOf<3>::set_own_pressures(bool);
template void FiniteKernelOf<3>::predict_pressures(std::span<const double>, std::span<const double>);
template void FiniteKernelOf<3>::accept_pressures();
template void FiniteKernelOf<3>::add_pressure_defect(std::span<double>);
template void FiniteKernelOf<3>::conserving_pressures();

}  // namespace couplet::elastic
