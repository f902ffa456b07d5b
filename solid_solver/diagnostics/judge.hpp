// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "solid_solver/body/solid_fields.hpp"
#include "solid_solver/diagnostics/effects.hpp"
#include "solid_solver/diagnostics/large_strain_estimate.hpp"
#include "solid_solver/diagnostics/strain_audit.hpp"
#include "solid_solver/motion/solid_stepper.hpp"
#include "solid_solver/stability/buckling_estimate.hpp"
#include "solid_solver/stability/equilibrium.hpp"

namespace couplet::io {
class Archive;
}

namespace couplet::solid {

/// Whether the answer of a run is to be trusted: what it has seen of itself so far. It says so once, and ends a
/// run of which nothing is left. All is collective.
class SolidJudge final {
 public:
  /// All by reference.
  SolidJudge(const SolidBody& body, const SolidStepper& stepper, const SolidFields& fields);

  /// Work against strain energy of the accepted state, and, where asked for, one face gradient against another.
  StrainAudit audit_strain(std::span<const double> points, bool compare_gradients) const;
  /// The same of the accepted state with two gradients: that of look() where it has just compared them.
  StrainAudit compared() const;
  /// The last one of the run; none before the first.
  const std::optional<StrainAudit>& last_audit() const { return audit_; }
  const EnergyAudit& energy_audit() const { return energy_audit_; }

  /// Looks at the accepted state; throws Error if nothing of the answer is left.
  void look();
  void see_gradient(std::span<const double> points);
  /// Of a static run, between solve and acceptance: what inertia would have been beside the load.
  void see_inertia();
  /// Of a static run at large strain, between solve and acceptance: whether its equilibrium holds.
  void see_equilibrium() { equilibrium_.see(body_, stepper_, fields_); }
  const SoftMotion& softest() const { return equilibrium_.softest(); }
  /// Of a run by arc length, after acceptance and at its end.
  void follow_path() { equilibrium_.follow(body_, fields_); }
  void finish_path(std::vector<std::string>& sentences) const { equilibrium_.finish(body_, sentences); }
  /// Of a linear static run in compression, after acceptance: how far its loads are from those that buckle it.
  void see_buckling();
  /// Of a linear static run, between solve and acceptance, where it is asked for.
  void estimate_large_strain();
  const std::optional<LargeStrainEstimate>& large_strain() const { return large_strain_; }
  SolidEvidence evidence() const;
  /// For the end of the run.
  std::vector<std::string> sentences() const;

  void visit(io::Archive& archive);

 private:
  void look_at_finite();
  void judge_energy(double strain, const char* cure);
  double residual_work(std::span<const double> unknowns) const;

  const SolidBody& body_;
  const SolidStepper& stepper_;
  const SolidFields& fields_;
  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  double largest_gradient_ = 0, inertia_over_load_ = 0;
  double largest_kinetic_ = 0, largest_strain_energy_ = 0;  // of a dynamic run [J]
  std::optional<StrainAudit> audit_, latest_;
  int steps_of_latest_ = -1;
  EnergyAudit energy_audit_;
  std::optional<LargeStrainEstimate> large_strain_;  // of the last step
  EquilibriumWatch equilibrium_;
  double buckling_told_ = BucklingEstimate::low;    // a factor below this is told
  double buckling_factor_ = BucklingEstimate::low;  // lowest of the run
  double compression_seen_ = 0;                     // of the last look at buckling
  base::Severity strain_told_ = base::Severity::note, energy_told_ = base::Severity::note;
};

}  // namespace couplet::solid
