// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

#include "common/diagnostics/diagnostics.hpp"
#include "thermocline/model/tank.hpp"

namespace couplet::thermocline {

/// Extremes of the run so far, which several diagnostics read.
struct Extremes {
  double flow = 0, advance = 0;     ///< largest |m| [kg/s] and |m| dt of a step of the bed [kg]
  double coldest = 0, hottest = 0;  ///< fluid, that of the start included [K]
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(flow, advance, coldest, hottest);
  }
};

using Seen = std::shared_ptr<Extremes>;
using diagnostics::Made;

/// Reads the tank and the extremes of its run.
class TankDiagnostic : public diagnostics::Diagnostic {
 public:
  TankDiagnostic(const TankView& view, Seen seen) : view_(view), seen_(std::move(seen)) {}

 protected:
  const PackedBed& bed() const { return view_.model.bed(); }
  /// Coldest and hottest fluid of the run and of what the flow will bring [K]: the bed of the first hours would be judged
  /// by another range than the run's.
  std::pair<double, double> range_to_come() const;
  /// Mass that must flow in for a front to cross the bed [kg]: its heat capacity over that of a kilogram of fluid.
  double crossing_mass() const { return bed().heat_capacity() / view_.fluid().specific_heat; }
  /// Reports an effect, unless its number is unknown.
  static void tell(diagnostics::Report& report, const diagnostics::EffectFinding& effect);
  /// Reports a sentence. `subject` tells it apart from others of the same id.
  void tell(diagnostics::Report& report, const char* id, std::string subject,
            const std::string& sentence) const;

  TankView view_;
  Seen seen_;
};

/// Adds the diagnostics of a tank.
void add_diagnostics(const TankView& view, diagnostics::Diagnostics& all);

}  // namespace couplet::thermocline
