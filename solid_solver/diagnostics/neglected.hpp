// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/diagnostics/diagnostics.hpp"
#include "solid_solver/body/solid_fields.hpp"
#include "solid_solver/diagnostics/large_strain.hpp"
#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

/// Finding about an effect that a case neglects or includes needlessly. Empty if the number is unknown (NaN)
/// or not relevant to this case.
using Opinion = std::optional<diagnostics::Finding>;

/// `inertia_over_load`: largest ratio in a static run with several steps.
Opinion neglected_inertia(const SolidParameters& parameters, double inertia_over_load);
/// `kinetic_over_strain`: largest energy ratio in a dynamic run.
Opinion spare_inertia(double kinetic_over_strain, double steps);
/// `turns`: integral over time of the angular frequency and twice the kinetic energy, over the largest energy.
Opinion neglected_damping(const SolidParameters& parameters, double turns);
/// `large_strain`: absent if not known or, where the run `is_bounded` by its first terms, too small to matter. `buckling_factor`:
/// NaN unless it is low.
Opinion neglected_geometry(const SolidParameters& parameters, const Deformation& largest,
                           const std::optional<LargeStrainEstimate>& large_strain, bool is_bounded,
                           double buckling_factor);
/// `share_of_yield`: largest equivalent stress over the yield strength.
Opinion neglected_yielding(double share_of_yield);
/// Without a yield strength: `strain` is the largest one.
Opinion unknown_yielding(const SolidParameters& parameters, double strain);
Opinion near_incompressibility(const SolidParameters& parameters);
/// `gradient`: largest displacement gradient. `range`, `change`: of the temperatures, and from the reference [K].
Opinion neglected_thermal_strain(const SolidParameters& parameters, double gradient, double range,
                                 double change);
/// Stiffening by the heat of deformation, thesis (2.27), needed or not.
Opinion thermoelastic_coupling(const SolidParameters& parameters, double coupling_number);

inline void add(diagnostics::Report& report, Opinion opinion) {
  if (opinion) report.findings.push_back(std::move(*opinion));
}

}  // namespace couplet::solid
