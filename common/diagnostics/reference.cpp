// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/reference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace couplet::diagnostics {
namespace {

constexpr double since_rejection = 0.25;  // fraction of the time since a rejected step that counts

// References that are kept elsewhere:
//   fluid: largest speed and energy   in its state; floors: a cell per step, EnergyCheck::energy_at_rest(); begin_step() forgets
//   fluid: energy of late             EnergyLedger; the same floor, decays
//   errors of steps                   time::StepErrors; the last quarter of the run
//   flow of a closed fluid            coupler::VolumeLevel; decays
//   range of a steady temperature     HeatStorage; floor: linear tolerance times temperature
//   displacement, beside contact      MissingContact; floor: machine epsilon times place; of the accepted state
constexpr std::array all_references{
    ReferenceEntry{"coupling: motion of the interface", true, "tolerance of the coupling"},
    ReferenceEntry{"coupling: swings of the interface", true, "none: beside other swings"},
    ReferenceEntry{"fluid: mean speed", true, "pressure tolerance, as a speed"},
    ReferenceEntry{"heat: range of temperature", false, "linear tolerance times temperature"},
    ReferenceEntry{"solid: energy supplied", false, "machine epsilon times modulus times volume"},
    ReferenceEntry{"solid: work of the loads", false, "none: both works are products of one displacement"},
};

}  // namespace

std::span<const ReferenceEntry> references() { return all_references; }

Reference::Reference(const char* name)
    : entry_(std::ranges::find(all_references, std::string(name), &ReferenceEntry::name)) {
  if (entry_ == all_references.end())
    throw std::logic_error(std::string("reference.cpp has no row '") + name + "'");
}

void Reference::add(double value, double dt) {
  time_ += dt;
  value_ = std::max(value, value_ * std::exp(-dt / (since_rejection * time_)));
}

double Reference::share(double part, double rounding) const {
  if (std::abs(part) <= rounding || !(value_ > 0)) return std::isnan(part) ? part : 0;
  return part / std::max(value_, rounding);
}

}  // namespace couplet::diagnostics
