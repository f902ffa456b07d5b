// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/diagnostics/error_parts.hpp"
#include "common/time/step_errors.hpp"
#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_fields.hpp"
#include "solid_solver/diagnostics/judge.hpp"
#include "solid_solver/diagnostics/phase_drift.hpp"
#include "solid_solver/motion/solid_stepper.hpp"

namespace couplet::solid {

/// What a solid's run leaves in its displacement:
///   mesh    by how much the work of the stresses misses the strain energy, which equilibrium would make equal, or,
///           if more, what recovered strains differ from those of the faces (symmetric gradient: its work misses nothing
///           by itself), or the square of the relative difference of two face gradients' strains: an energy errs by the
///           square of what the strains err; see StrainAudit::missed_by_mesh().
///           In motion what that makes of the phase comes beside it, see PhaseDrift. A body at rest tells nothing.
///   step    sum of the local errors, see VelocityErrors; static: none
///   linear  static: the work of what equilibrium misses over that of the loads, which is the error of the compliance;
///           dynamic: the relative residuals of all steps, see StepErrors
/// Thermal strain: see weighted_mesh_error; in motion it makes the mesh's part unknown.
/// Temperatures that are solved for add what they err by, over their distance from the reference, times the share of the strain energy
/// that their strain makes. At finite strain the mesh's part is half the square of the difference of two gradients' Green strains, times
/// how softly the deformed body follows a change of its stiffness (a static run: one linear solve with the tangent), or, if more,
/// what its softest motion makes of it, see soft_mesh_error(). Collective.
class SolidErrorEstimate {
 public:
  /// All by reference.
  SolidErrorEstimate(const SolidBody& body, const SolidStepper& stepper, const SolidFields& fields,
                     const SolidJudge& judge);
  /// Between solve and acceptance.
  void see_step();
  /// After the last step.
  diagnostics::ErrorParts parts() const;
  /// For checkpoints, on the body's mesh. Collective.
  void save(io::CheckpointWriter& file) const;
  void load(io::CheckpointReader& file);

 private:
  void see_swing(const SolidState& now, const time::StepErrors::Seen& step);
  double left_by_solver() const;
  double missed_work() const;
  void add_loads(diagnostics::ErrorParts& parts) const;
  double missed_of_large_strain(const SolidState& state, std::span<const double> unknowns) const;
  double thermal_mesh_error(double known) const;
  double finite_mesh_error() const;
  double mean_square(std::span<const double> cells) const;

  const SolidBody& body_;
  const SolidStepper& stepper_;
  const SolidFields& fields_;
  const SolidJudge& judge_;
  double volume_ = 0;  // of the body [m^3]
  time::VelocityErrors steps_;
  time::StepErrors linear_;
  PhaseDrift drift_;
};

}  // namespace couplet::solid
