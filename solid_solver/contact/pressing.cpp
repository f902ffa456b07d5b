// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/contact/pressing.hpp"

#include <algorithm>
#include <cmath>

#include "common/contact/contact.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {

void Pressing::look(std::span<const double> along) {
  for (std::size_t i = 0; i < force_.size(); ++i) {
    const double kappa = seat_.faces()[i].kappa, delta = base_[i] - factor_ * along[i];
    const contact::Push push =
        before_.empty() ? contact::push(delta + multiplier_[i] / kappa) : contact::push(before_[i], delta);
    force_[i] = kappa * push.force;
    stiffness_[i] = kappa * push.slope * factor_;
  }
}

void Pressing::push_off(std::span<const double> unknowns, std::span<const double> known,
                        std::span<double> rows) {
  look(seat_.along(unknowns, known));
  seat_.add_to_rows(force_, rows);
}

double Pressing::take_multipliers(MPI_Comm comm) {
  double change = 0, largest = 0;
  for (std::size_t i = 0; i < force_.size(); ++i) {
    change = std::max(change, std::abs(force_[i] - multiplier_[i]));
    largest = std::max(largest, force_[i]);
  }
  multiplier_ = force_;
  change = parallel::max(comm, change);
  largest = parallel::max(comm, largest);
  return largest > 0 ? change / largest : change > 0 ? 1 : 0;
}

void Pressing::add_stiffness(std::span<const double> v, std::span<double> rows) const {
  std::vector<double> pull = seat_.along(v, {});
  for (std::size_t i = 0; i < pull.size(); ++i) pull[i] *= stiffness_[i];
  seat_.add_to_rows(pull, rows);
}

}  // namespace couplet::solid
