// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/diagnostics/diagnostics.hpp"
#include "solid_solver/body/solid_fields.hpp"
#include "solid_solver/motion/solid_stepper.hpp"
#include "solid_solver/output/output.hpp"
#include "solid_solver/thermal/heat.hpp"

namespace couplet::solid {

/// State of a solid run after the last accepted step, as diagnostics see it.
struct SolidView {
  const SolidBody& body;
  const SolidStepper& stepper;
  const SolidFields& fields;
  const SolidOutput& output;
  const SolidContext& context;

  const SolidState& now() const { return stepper.state(); }
  const SolidState& before() const { return stepper.trial(); }  ///< at the start of the accepted step
  MPI_Comm comm() const { return body.mesh().comm; }
  std::vector<double> unknowns() const { return body.unknowns_of(now().cell_u, now().face_u); }
  /// Known columns of the kernel in the accepted displacement.
  std::vector<double> known() const {
    return body.known_of({now().cell_u, now().face_u, fields.point_displacement()});
  }
};

/// View of a solid that only conducts heat.
struct HeatView {
  const Heat& heat;
  const SolidParameters& parameters;
  const SolidContext& context;
};

/// Root mean square over the volume of `width` values per owned cell. Collective.
double root_mean_square(const mesh::Mesh& mesh, const mesh::Geometry& geometry, int width,
                        std::span<const double> cells);

class LinearBuckling;
class LargeStrainChange;
class Stability;
class StrainEnergy;

// Each makes a diagnostic, or nullptr if it does not apply to the solid.
diagnostics::Made linear_theory(const SolidView& view, std::shared_ptr<const LargeStrainChange> large_strain,
                                std::shared_ptr<const LinearBuckling> buckling);
diagnostics::Made neglected_inertia(const SolidView& view);
diagnostics::Made limits_of_material(const SolidView& view);
diagnostics::Made effects_of_heat(const SolidView& view);
diagnostics::Made missing_contact(const SolidView& view);
diagnostics::Made neglected_weight(const SolidView& view, const std::shared_ptr<StrainEnergy>& strain);
diagnostics::Made heat_swing(const Heat& heat);
diagnostics::Made heat_storage(const Heat& heat);
diagnostics::Made impossible_temperature(const Heat& heat);
diagnostics::Made heat_error(const Heat& heat);
diagnostics::Made solid_error(const SolidView& view, std::shared_ptr<StrainEnergy> strain);
diagnostics::Made quantities(const SolidView& view);
diagnostics::Made quantities(const HeatView& view);
diagnostics::Made stress_error(const SolidView& view);

/// Adds all diagnostics of a solid.
void add_diagnostics(const SolidView& view, diagnostics::Diagnostics& all);
void add_diagnostics(const HeatView& view, diagnostics::Diagnostics& all);

}  // namespace couplet::solid
