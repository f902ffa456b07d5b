// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/diagnostics/diagnostics.hpp"
#include "solid_solver/body/solid_fields.hpp"
#include "solid_solver/diagnostics/large_strain_estimate.hpp"
#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

/// An opinion on an effect that a scene leaves out or has in vain, from numbers that the run has seen. Nothing where the
/// number is not known (NaN) or says nothing about this scene.
using Opinion = std::optional<diagnostics::Finding>;

/// Largest inertia over the load of a static run with several steps.
Opinion neglected_inertia(const SolidParameters& parameters, double inertia_over_load);
/// Largest kinetic over largest strain energy of a dynamic run.
Opinion spare_inertia(double kinetic_over_strain, double steps);
/// `large_strain`: nothing if it was not asked for; `buckling_factor`: NaN unless it is low.
Opinion neglected_geometry(const SolidParameters& parameters, const Deformation& largest,
                           const std::optional<LargeStrainEstimate>& large_strain, double buckling_factor);
/// Largest equivalent stress over the yield strength.
Opinion neglected_yielding(double share_of_yield);
Opinion near_incompressibility(const SolidParameters& parameters);
/// `gradient`: the largest of the displacement; `range` of temperatures and largest `change` from the reference [K].
Opinion neglected_thermal_strain(const SolidParameters& parameters, double gradient, double range,
                                 double change);
/// Stiffening by the heat of deformation, thesis (2.27); in vain where the scene has it.
Opinion thermoelastic_coupling(const SolidParameters& parameters, double coupling_number);

inline void add(diagnostics::Report& report, Opinion opinion) {
  if (opinion) report.findings.push_back(std::move(*opinion));
}

}  // namespace couplet::solid
