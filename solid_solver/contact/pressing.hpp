// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "solid_solver/contact/seat.hpp"

namespace couplet::solid {

/// How a seat answers in one solve. What is solved for, w, shows the penetration delta = base - factor d . w on each face:
/// at the end of the step, whose work is that of its energy (conserving rule), or where the scheme has its equilibrium.
/// A rigid seat (static analyses without a stiffness) has its pressure from multipliers lambda [powell1969]:
/// kappa <delta + lambda / kappa>, lambda taking that force again and again until delta vanishes.
class Pressing final {
 public:
  /// `before`: penetrations at the start of the step, empty: force of delta itself.
  Pressing(const Seat& seat, double factor, std::vector<double> base, std::vector<double> before)
      : seat_(seat),
        factor_(factor),
        base_(std::move(base)),
        before_(std::move(before)),
        multiplier_(seat.size(), 0),
        force_(multiplier_),
        stiffness_(multiplier_) {}

  const Seat& seat() const { return seat_; }
  /// Forces and their tangent for w of this motion along the direction (Seat::along()).
  void look(std::span<const double> along);
  /// look() at w of these unknowns and known columns; rows += the forces. Collective.
  void push_off(std::span<const double> unknowns, std::span<const double> known, std::span<double> rows);
  /// Of the last look() [N], pushing off, and what they grow by with a motion towards the seat [N/m].
  const std::vector<double>& forces() const { return force_; }
  const std::vector<double>& stiffness() const { return stiffness_; }
  /// The multipliers become the forces of the last look(). Gives the largest change over the largest force. Collective.
  double take_multipliers(MPI_Comm comm);
  /// rows += the stiffness of the last look() on v. Collective.
  void add_stiffness(std::span<const double> v, std::span<double> rows) const;

 private:
  const Seat& seat_;
  double factor_;
  std::vector<double> base_, before_;
  std::vector<double> multiplier_, force_, stiffness_;
};

}  // namespace couplet::solid
