// SPDX-License-Identifier: Apache-2.0
// The symmetric operator with the mean stresses of its cells as unknowns of their own.
#include <algorithm>

#include "common/elasticity/symmetric/symmetric_kernel.hpp"

namespace couplet::elastic {

template <int D>
void SymmetricKernel<D>::apply_mixed(std::span<const double> unknowns, std::span<const double> pressure,
                                     double mass_factor, std::span<double> result, std::span<double> defect) {
  space_.fill(unknowns, {});
  space_.clear_forces();
  const std::span<double> cells = sum_volumes();
  for (std::size_t c = 0; c < bulk_.size(); ++c) {
    defect[c] = cells[c] - pressure[c] / bulk_[c];
    cells[c] = pressure[c];
  }
  mesh_.cells.update_ghosts(cells);
  forces_of_stress();
  space_.add_springs({});
  if (mass_factor > 0) space_.add_mass_forces(mass_factor);
  space_.collect();
  space_.take_rows(unknowns, {}, result);
}

template void SymmetricKernel<2>::apply_mixed(std::span<const double>, std::span<const double>, double,
                                              std::span<double>, std::span<double>);

template void SymmetricKernel<3>::apply_mixed(std::span<const double>, std::span<const double>, double,
                                              std::span<double>, std::span<double>);

}  // namespace couplet::elastic
