// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

#include "common/diagnostics/diagnostics.hpp"
#include "thermocline/model/tank.hpp"

namespace couplet::thermocline {

/// Extreme values of the run so far, used by several diagnostics.
struct Extremes {
  double flow = 0, advance = 0;     ///< largest |m| [kg/s], and |m| dt of a bed step [kg]
  double moved = 0;                 ///< sum of |m| dt [kg]
  double coldest = 0, hottest = 0;  ///< fluid, including the initial state [K]
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(flow, advance, moved, coldest, hottest);
  }
};

/// Tank and the extreme values that its diagnostics share.
struct RunOfTank {
  const TankView& view;
  std::shared_ptr<Extremes> seen;
};

/// Base of diagnostics that read the tank and its extreme values.
class TankDiagnostic : public diagnostics::Diagnostic {
 public:
  explicit TankDiagnostic(const RunOfTank& run) : view_(run.view), seen_(run.seen) {}

 protected:
  const PackedBed& bed() const { return view_.model.bed(); }
  /// Coldest and hottest fluid of the run and of the future inflow [K]. Without the latter, the first hours
  /// would be judged by a different range.
  std::pair<double, double> range_to_come() const;
  /// Inflow required for a front to cross the bed [kg]: its heat capacity over the fluid's specific heat.
  double crossing_mass() const { return bed().heat_capacity() / view_.fluid().specific_heat; }
  /// Relative variance of a front by film and grains on its way through the bed: 2 (G c/(h a)) (1 - beta)^2
  /// per meter over the squared height, beta the fluid's share of the heat capacity (Schumann's model at late
  /// times).
  double variance_of_grains() const;
  /// Reports an effect, unless its number is unknown.
  static void add(diagnostics::Report& report, const diagnostics::EffectFinding& effect);
  /// Reports a sentence. `subject` distinguishes it from others with the same id.
  void add(diagnostics::Report& report, const char* id, std::string subject,
           const std::string& sentence) const;

  TankView view_;
  std::shared_ptr<Extremes> seen_;
};

// Each makes a diagnostic, or nullptr if it does not apply to the tank.
diagnostics::Made extremes(const RunOfTank& run);
diagnostics::Made energy_balance(const RunOfTank& run);
diagnostics::Made fluid_range(const RunOfTank& run);
diagnostics::Made grains(const RunOfTank& run);
diagnostics::Made still_bed(const RunOfTank& run);
diagnostics::Made inversions(const RunOfTank& run);
diagnostics::Made pumping(const RunOfTank& run);
diagnostics::Made gas(const RunOfTank& run);
diagnostics::Made wall_strength(const RunOfTank& run);
diagnostics::Made wall_mechanics(const RunOfTank& run);
diagnostics::Made surroundings(const RunOfTank& run);
diagnostics::Made unused_input(const RunOfTank& run);
diagnostics::Made front_error(const RunOfTank& run);

/// Adds the diagnostics of a tank.
void add_diagnostics(const TankView& view, diagnostics::Diagnostics& all);

}  // namespace couplet::thermocline
